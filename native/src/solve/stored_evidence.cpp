// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/stored_evidence.hpp>

namespace mimetic {

Eigen::VectorXf pack_evidence(const FrameEstimate& estimate) {
    const Eigen::Index size = estimate.gradient.size();
    Eigen::VectorXf packed(size * (size + 1) / 2 + size);
    Eigen::Index at = 0;
    for (Eigen::Index row = 0; row < size; ++row) {
        packed.segment(at, row + 1) = estimate.information.row(row).head(row + 1).transpose().cast<float>();
        at += row + 1;
    }
    packed.tail(size) = estimate.gradient.cast<float>();
    return packed;
}

int evidence_state_size(Eigen::Index length) {
    const auto size =
        static_cast<int>(std::lround((std::sqrt(9 + 8. * static_cast<double>(length)) - 3) / 2));
    return size * (size + 3) / 2 == length ? size : -1;
}

Eigen::MatrixXd stored_information(const Eigen::VectorXf& evidence, Eigen::Index size) {
    Eigen::MatrixXd information(size, size);
    Eigen::Index at = 0;
    for (Eigen::Index row = 0; row < size; ++row) {
        information.row(row).head(row + 1) = evidence.segment(at, row + 1).transpose().cast<double>();
        at += row + 1;
    }
    information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
    return information;
}

FrameEstimate stored_estimate(const Eigen::Isometry3d& camera_from_head, const Matrix6& pose_covariance,
                              VectorIn values, VectorIn values_std, const Eigen::VectorXf& evidence,
                              double quality, bool is_held) {
    const Eigen::Index size = 6 + values.size();
    if (evidence.size() != size * (size + 1) / 2 + size || values_std.size() != values.size()) {
        throw InvalidInput("evidence of " + std::to_string(evidence.size()) + " numbers is not of " +
                           std::to_string(values.size()) + " values");
    }
    FrameEstimate estimate;
    estimate.camera_from_head = camera_from_head;
    estimate.values = values;
    estimate.quality = quality;
    estimate.held = is_held;
    constexpr double kSurest = 1e-4;
    estimate.covariance.setZero(size, size);
    estimate.covariance.topLeftCorner<6, 6>() = pose_covariance + 1e-12 * Matrix6::Identity();
    estimate.covariance.diagonal().tail(values.size()) = values_std.cwiseMax(kSurest).cwiseAbs2();
    estimate.information = stored_information(evidence, size);
    estimate.gradient = evidence.tail(size).cast<double>();
    return estimate;
}

}  // namespace mimetic
