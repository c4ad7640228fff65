// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence_bias.hpp"

#include <Eigen/LU>

#include "seen_point.hpp"

namespace mimetic {

namespace {

// Muscles move where a pin pulls before the head does: who means the head puts several pins, or its pose
constexpr double kRotationStd = 6e-3;     // rad
constexpr double kTranslationStd = 1e-3;  // metres
constexpr double kBoundStd = 1e-4;        // of a value's shift to its bound
constexpr double kNearest = .02;          // metres before the camera
// Share of its variance by which the bias may miss a correction: its deviation weighs it against others and
// the pictures of its frame, where it is a measurement itself, and must not count twice
constexpr double kMissed = .01;

void append(CorrectionRows& rows, const Eigen::RowVectorXd& row, double residual, double std) {
    const Eigen::Index count = rows.residual.size();
    rows.rows.conservativeResize(count + 1, row.size());
    rows.residual.conservativeResize(count + 1);
    rows.std.conservativeResize(count + 1);
    rows.rows.row(count) = row;
    rows.residual[count] = residual;
    rows.std[count] = std;
}

void append_pin(const SkinPin& pin, const Camera& camera, const FaceState& state, CorrectionRows& rows) {
    const Eigen::Vector3d point = pin.neutral + pin.modes.transpose() * state.values;
    const SeenPoint seen(camera, state.camera_from_head, point);
    if (!(seen.in_camera.z() > kNearest)) {
        return;
    }
    const Eigen::Vector2d missing = pin.pixel - camera.project(seen.in_camera);
    Eigen::MatrixXd jacobian(2, FaceStep::kPose + state.values.size());
    jacobian << seen.by_rotation, seen.by_shift, seen.by_point * pin.modes.transpose();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
        append(rows, jacobian.row(axis), missing[axis], pin.std);
    }
}

}  // namespace

Eigen::MatrixXd CorrectionRows::information() const {
    return rows.transpose() * std.cwiseAbs2().cwiseInverse().asDiagonal() * rows;
}

Eigen::VectorXd CorrectionRows::pull() const {
    return rows.transpose() * residual.cwiseQuotient(std.cwiseAbs2());
}

CorrectionRows linearised(const Correction& correction, const Camera& camera, const FaceState& state) {
    const Eigen::Index size = FaceStep::kPose + state.values.size();
    CorrectionRows rows{MatrixRows(0, size), Eigen::VectorXd(), Eigen::VectorXd()};
    for (const SkinPin& pin : correction.pins) {
        append_pin(pin, camera, state, rows);
    }
    for (const PosePin& pose : correction.poses) {
        const FaceState there{pose.camera_from_head, state.values};
        const FaceStep missing = there.difference_from(state);
        for (Eigen::Index axis = 0; axis < FaceStep::kPose; ++axis) {
            append(rows, Eigen::RowVectorXd::Unit(size, axis), missing.flat[axis],
                   axis < 3 ? pose.rotation_std : pose.translation_std);
        }
    }
    for (const ValuePin& value : correction.values) {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size);
        row.tail(state.values.size()) = value.weights.transpose();
        append(rows, row, value.target - value.weights.dot(state.values), value.std);
    }
    return rows;
}

double bias_correlation(double num_frames, double reach) {
    const double share = std::min(1., std::abs(num_frames) / reach);
    return std::pow(1 - share, 3) * (1 + 3 * share);
}

EvidenceBias::EvidenceBias(const FaceMotion& motion, const std::vector<Correction>& corrections)
    : motion_(motion),
      corrections_(corrections),
      variance_(FaceStep::kPose + motion.lower.size()),
      is_bound_(corrections.size(), std::vector<bool>(static_cast<std::size_t>(motion.lower.size()), false)) {
    variance_.head<3>().setConstant(kRotationStd * kRotationStd);
    variance_.segment<3>(3).setConstant(kTranslationStd * kTranslationStd);
    variance_.tail(motion.lower.size()) = motion.prior_std.cwiseAbs2();
}

void EvidenceBias::fit(const std::vector<CorrectionRows>& rows,
                       const std::vector<Eigen::VectorXd>& evidence) {
    constexpr int kMostRounds = 12;
    rows_ = rows;
    for (std::vector<bool>& values : is_bound_) {
        std::fill(values.begin(), values.end(), false);
    }
    for (int round = 0; round < kMostRounds; ++round) {
        solve();
        if (!bind(evidence)) {
            break;
        }
    }
}

/// The process's regression: what each correction's rows add, by the rows of all.
void EvidenceBias::solve() {
    const std::size_t count = corrections_.size();
    std::vector<Eigen::Index> begin(count + 1, 0);
    for (std::size_t k = 0; k < count; ++k) {
        begin[k + 1] = begin[k] + rows_[k].residual.size();
    }
    const Eigen::Index size = begin[count];
    Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd missing(size), noise(size);
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Index own = rows_[k].residual.size();
        missing.segment(begin[k], own) = rows_[k].residual;
        noise.segment(begin[k], own) = kMissed * rows_[k].std.cwiseAbs2();
        const Eigen::MatrixXd moved = rows_[k].rows * variance_.asDiagonal();
        for (std::size_t other = 0; other < count; ++other) {
            spread.block(begin[k], begin[other], own, rows_[other].residual.size()) =
                bias_correlation(corrections_[k].index - corrections_[other].index,
                                 corrections_[other].reach) *
                moved * rows_[other].rows.transpose();
        }
    }
    // Empirical Bayes: a bias that is far larger than usual is no less believed than a small one.
    const auto solved = [&](double scale) {
        const Eigen::MatrixXd total = scale * spread + Eigen::MatrixXd(noise.asDiagonal());
        return Eigen::VectorXd(total.partialPivLu().solve(missing));
    };
    const double unusual = size > 0 ? missing.dot(solved(1)) / static_cast<double>(size) : 1;
    const double scale = std::max(1., unusual);
    const Eigen::VectorXd weights = scale * solved(scale);
    sources_.clear();
    for (std::size_t k = 0; k < count; ++k) {
        sources_.push_back(variance_.cwiseProduct(rows_[k].rows.transpose() *
                                                  weights.segment(begin[k], rows_[k].residual.size())));
    }
}

/// Values that a shift takes out of their bounds in a corrected frame stop there; whether there were any.
bool EvidenceBias::bind(const std::vector<Eigen::VectorXd>& evidence) {
    constexpr double kBeyond = 1e-3;
    bool is_new = false;
    for (std::size_t k = 0; k < corrections_.size(); ++k) {
        const Eigen::VectorXd shift_here = shift(corrections_[k].index);
        for (Eigen::Index value = 0; value < motion_.lower.size(); ++value) {
            const double place = evidence[k][value] + shift_here[FaceStep::kPose + value];
            const double inside = std::clamp(place, motion_.lower[value], motion_.upper[value]);
            if (std::abs(place - inside) > kBeyond && !is_bound_[k][static_cast<std::size_t>(value)]) {
                append(rows_[k], Eigen::RowVectorXd::Unit(shift_here.size(), FaceStep::kPose + value),
                       inside - evidence[k][value], kBoundStd);
                is_bound_[k][static_cast<std::size_t>(value)] = is_new = true;
            }
        }
    }
    return is_new;
}

Eigen::VectorXd EvidenceBias::shift(int index) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(variance_.size());
    for (std::size_t k = 0; k < corrections_.size(); ++k) {
        sum += bias_correlation(corrections_[k].index - index, corrections_[k].reach) * sources_[k];
    }
    return sum;
}

}  // namespace mimetic
