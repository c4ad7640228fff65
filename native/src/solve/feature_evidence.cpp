// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature_evidence.hpp"

#include <mimetic/shared/scale.hpp>

namespace mimetic {

namespace {

/// Metres between the eyes' middles; where no eyes are given, the usual distance.
double interpupillary_of(const std::vector<OpeningEvidence>& openings) {
    std::vector<Eigen::Vector3d> eyes;
    for (const OpeningEvidence& opening : openings) {
        if (opening.lines().opening().lid_upper >= 0) {
            eyes.push_back(opening.lines().middle());
        }
    }
    return eyes.size() == 2 ? (eyes[0] - eyes[1]).norm() : kPupilDistance;
}

}  // namespace

FeatureEvidence::FeatureEvidence(const TrackedFace& face, const FeatureInputs& inputs, const ColorView& image,
                                 const FaceState& at_rest)
    : face_(face), source_(inputs.source), reference_(at_rest) {
    if (!source_) {
        return;
    }
    for (const FeatureOpening& opening : inputs.openings) {
        openings_.emplace_back(face, opening);
    }
    interpupillary_ = interpupillary_of(openings_);
    look(image, at_rest);
    for (std::size_t i = 0; i < openings_.size(); ++i) {
        const FaceState learned = openings_[i].learn(at_rest, seen_[i], interpupillary_);
        reference_.values += learned.values - at_rest.values;
    }
}

void FeatureEvidence::look(const ColorView& image, const FaceState& near) {
    if (source_) {
        seen_ = source_(image, near.camera_from_head);
        seen_.resize(openings_.size());
    }
}

void FeatureEvidence::leave_out(const Cover& cover) {
    constexpr double kMostHidden = .1;  // of the points: the networks guess all from those that they see
    for (SeenOpening& opening : seen_) {
        double hidden = 0, points = 0;
        for (const Points2& line : opening.lines) {
            const auto hides = [&cover](const Eigen::Vector2d& at) { return cover.hides(at); };
            hidden += share_of(line, hides) * static_cast<double>(line.rows());
            points += static_cast<double>(line.rows());
        }
        if (hidden > kMostHidden * points) {
            opening = {};
        }
    }
}

void FeatureEvidence::look_away() { seen_.assign(openings_.size(), {}); }

StepPrior FeatureEvidence::terms(const FaceState& state) const {
    const Eigen::Index size = face_.num_unknowns();
    StepPrior sum{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    for (std::size_t i = 0; i < openings_.size(); ++i) {
        const StepPrior own = openings_[i].terms(state, seen_[i], interpupillary_);
        sum.information += own.information;
        sum.gradient += own.gradient;
    }
    return sum;
}

DetailTerms FeatureEvidence::detail_terms(const FaceState& state) const {
    DetailTerms sum(face_.motion.detail_std.size(), face_.num_unknowns());
    for (std::size_t i = 0; i < openings_.size(); ++i) {
        const DetailTerms own = openings_[i].detail_terms(state, seen_[i], interpupillary_);
        sum.information += own.information;
        sum.coupling += own.coupling;
        sum.pull += own.pull;
    }
    return sum;
}

std::array<SeenIris, 2> FeatureEvidence::irises() const {
    std::array<SeenIris, 2> irises;
    std::size_t eye = 0;
    for (std::size_t i = 0; i < seen_.size() && eye < irises.size(); ++i) {
        if (openings_[i].lines().opening().lid_upper >= 0) {
            irises[eye++] = seen_[i].iris;
        }
    }
    return irises;
}

FaceState FeatureEvidence::with_lids(FaceState state) const {
    for (std::size_t i = 0; i < openings_.size(); ++i) {
        state = openings_[i].with_lids(std::move(state), seen_[i], interpupillary_);
    }
    return state;
}

}  // namespace mimetic
