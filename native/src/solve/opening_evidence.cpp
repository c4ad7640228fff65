// SPDX-License-Identifier: GPL-3.0-or-later
#include "opening_evidence.hpp"

#include "opening_noise.hpp"

namespace mimetic {

namespace {

// In interpupillary distances. Measured on real frames marked by hand (docs/measured/real-faces.md): once a
// person's constant offset is known, lids are .5 % off and lips about 1 %; neighbouring frames err alike, so
// that each counts for less than one.
constexpr OpeningNoise kLidNoise{.010, .007, .006, .006, .3, 0, 0, 0};
// A slit's two edges err alike: shut lips are seen to touch within half a per cent, and open ones a tenth too
// far apart. The head's lower lip comes down as a V under the jaw, those of people as a U: beside the midline
// the skin of lip and chin follows the jaw by a tenth to a fifth more than the head's.
constexpr OpeningNoise kLipNoise{.015, .012, .009, .003, .3, .99, .12, .2};
// How far a person's lines lie from the fitted head's, and the networks' from the person's
constexpr OpeningNoise kLidBias{.04, .012, .012, .004, 0, 0, 0, 0};
constexpr OpeningNoise kLipBias{.05, .020, .015, .002, 0, .995, 0, 0};

constexpr double kShutAtRest = .3;     // s.d. in the reference frame of what shuts: a person may be sleepy
constexpr double kOtherAtRest = .02;   // of all other values
constexpr double kHidden = .3;         // cosine: below, an opening is too oblique to measure
constexpr double kFrontal = .8;        // cosine: above, as from the front
constexpr double kLargestFactor = 12;  // of the noise of nearly hidden openings
constexpr double kImplausible = 3;     // standard deviations, root mean square

}  // namespace

OpeningEvidence::OpeningEvidence(const TrackedFace& face, const FeatureOpening& opening)
    : face_(face),
      lines_(face.surface, opening),
      bias_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lines_.places().size()))),
      bias_covariance_(covariance_of(is_eye() ? kLidBias : kLipBias, lines_.places(), 0, 1)) {}

std::optional<OpeningEvidence::Rows> OpeningEvidence::rows_at(const FaceState& state, const SeenOpening& seen,
                                                              double interpupillary) const {
    const std::optional<OpeningOffsets> found = lines_.compare(face_.camera, state, seen, interpupillary);
    if (!found || found->frontality <= kHidden || seen.presence <= 0) {
        return {};
    }
    const double sight = std::min(1., (found->frontality - kHidden) / (kFrontal - kHidden)) * seen.presence;
    const double factor = std::min(kLargestFactor, seen.doubt / sight);
    const OpeningNoise& noise = is_eye() ? kLidNoise : kLipNoise;
    Rows rows{found->offsets, found->by_values, found->by_detail,
              covariance_of(noise, lines_.places(), found->pixel, factor)};
    rows.covariance += std::pow(noise.width * factor, 2) * found->from_slit * found->from_slit.transpose();
    if (const int jaw = lines_.opening().jaw; jaw >= 0) {
        const Eigen::VectorXd moved = rows.by_values.col(jaw) * state.values[jaw];
        rows.covariance += jaw_covariance(noise.by_jaw, lines_.places(), moved);
    }
    const Eigen::Index count = rows.offsets.size();
    Eigen::MatrixXd share = Eigen::MatrixXd::Identity(count, count);  // of each offset at this state
    if (is_eye()) {
        const double closure = std::clamp(state.values[lines_.opening().lid_upper], 0., 1.);
        for (Eigen::Index upper = 0; upper < count / 2; ++upper) {
            const Eigen::Index lower = upper + count / 2;
            share(upper, upper) = 1 - closure;
            share(upper, lower) = closure;
            if (closure > 0 && closure < 1) {
                rows.by_values(upper, lines_.opening().lid_upper) += bias_[lower] - bias_[upper];
            }
        }
    }
    rows.offsets -= share * bias_;
    rows.covariance += share * bias_covariance_ * share.transpose();
    return rows;
}

FaceState OpeningEvidence::learn(const FaceState& at_rest, const SeenOpening& seen, double interpupillary) {
    FaceState state = at_rest;
    const std::optional<Rows> rows = rows_at(at_rest, seen, interpupillary);
    if (!rows) {
        return state;
    }
    Eigen::VectorXd variance = Eigen::VectorXd::Constant(state.values.size(), kOtherAtRest * kOtherAtRest);
    for (const int value : lines_.opening().shutting) {
        variance[value] = kShutAtRest * kShutAtRest;
    }
    const Eigen::MatrixXd to_values = variance.asDiagonal() * rows->by_values.transpose();
    const Eigen::LLT<Eigen::MatrixXd> total(rows->covariance + rows->by_values * to_values);
    const Eigen::VectorXd explained = total.solve(rows->offsets);
    for (const int value : lines_.opening().shutting) {
        state.values[value] += to_values.row(value).dot(explained);
    }
    state.keep_within(face_.motion);
    const Eigen::MatrixXd prior = bias_covariance_;
    bias_ += prior * explained;
    bias_covariance_ -= prior * total.solve(prior);
    return state;
}

/// Robust weight, 0 to 1, of offsets under the prior of the values: what no state explains is an occluder.
double OpeningEvidence::plausibility(const Rows& rows) const {
    const Eigen::MatrixXd total = rows.covariance + rows.by_values *
                                                        face_.motion.prior_std.cwiseAbs2().asDiagonal() *
                                                        rows.by_values.transpose();
    const double square = rows.offsets.dot(total.llt().solve(rows.offsets));
    return tukey_weight(std::sqrt(square / static_cast<double>(rows.offsets.size())) / kImplausible);
}

StepPrior OpeningEvidence::terms(const FaceState& state, const SeenOpening& seen,
                                 double interpupillary) const {
    const Eigen::Index size = face_.num_unknowns(), num_values = face_.num_values();
    StepPrior terms{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    if (const std::optional<Rows> rows = rows_at(state, seen, interpupillary)) {
        const double weight = plausibility(*rows);
        const Eigen::LLT<Eigen::MatrixXd> factor(rows->covariance);
        terms.information.bottomRightCorner(num_values, num_values) =
            weight * rows->by_values.transpose() * factor.solve(rows->by_values);
        terms.gradient.tail(num_values) = weight * rows->by_values.transpose() * factor.solve(rows->offsets);
    }
    return terms;
}

DetailTerms OpeningEvidence::detail_terms(const FaceState& state, const SeenOpening& seen,
                                          double interpupillary) const {
    DetailTerms terms(face_.motion.detail_std.size(), face_.num_unknowns());
    if (const std::optional<Rows> rows = rows_at(state, seen, interpupillary)) {
        const Eigen::MatrixXd weighted =
            plausibility(*rows) * Eigen::LLT<Eigen::MatrixXd>(rows->covariance).solve(rows->by_detail);
        terms.information = rows->by_detail.transpose() * weighted;
        terms.coupling.rightCols(face_.num_values()) = weighted.transpose() * rows->by_values;
        terms.pull = weighted.transpose() * rows->offsets;
    }
    return terms;
}

FaceState OpeningEvidence::with_lids(FaceState state, const SeenOpening& seen, double interpupillary) const {
    constexpr int kSteps = 3;  // a lid's margin turns about the eye: nearly linear
    if (!is_eye()) {
        return state;
    }
    const int lid = lines_.opening().lid_upper;
    for (int step = 0; step < kSteps; ++step) {
        const std::optional<Rows> rows = rows_at(state, seen, interpupillary);
        if (!rows || plausibility(*rows) <= 0) {
            return state;
        }
        const Eigen::VectorXd moved = rows->by_values.col(lid);
        const Eigen::LLT<Eigen::MatrixXd> factor(rows->covariance);
        const double prior = 1 / (face_.motion.prior_std[lid] * face_.motion.prior_std[lid]);
        state.values[lid] += (moved.dot(factor.solve(rows->offsets)) - prior * state.values[lid]) /
                             (moved.dot(factor.solve(moved)) + prior);
        state.keep_within(face_.motion);
    }
    return state;
}

}  // namespace mimetic
