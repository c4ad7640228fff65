// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/curve_noise.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/solve/solve.hpp>

namespace mimetic {

CurveNoise::CurveNoise(int num_frames, double ratio) {
    check_range("number of frames of a curve", num_frames, 3, 2000);
    check_range("ratio of smoothing", ratio, 0, 1000);
    Eigen::MatrixXd differences = Eigen::MatrixXd::Zero(num_frames - 2, num_frames);
    for (int i = 0; i + 2 < num_frames; ++i) {
        differences.row(i).segment<3>(i) << 1, -2, 1;
    }
    Eigen::MatrixXd system = ratio * ratio * differences.transpose() * differences;
    system.diagonal().array() += 1;
    smoother_ = system.llt().solve(Eigen::MatrixXd::Identity(num_frames, num_frames));
    const Eigen::MatrixXd covariance = smoother_ * smoother_.transpose();
    const double trace = covariance.trace();
    scale_ = std::sqrt(num_frames / trace);
    effective_count_ = trace * trace / covariance.squaredNorm();
}

Eigen::MatrixXd CurveNoise::smoothed(const Eigen::Ref<const Eigen::MatrixXd>& curves) const {
    return smoother_ * curves;
}

Eigen::MatrixXd CurveNoise::correlated(const Eigen::Ref<const Eigen::MatrixXd>& normals) const {
    return scale_ * (smoother_ * normals);
}

double smoothing_ratio(double value_std) {
    // Most of a value's standard deviation is error that stays the same from frame to frame, which the
    // smoother does not see as noise: this share gave the nearest exponents on `mimetic evaluate timing --set
    // tuning`.
    constexpr double kNoiseShare = .5;
    return std::min(kNoiseShare * std::max(0.0, value_std) / SmootherOptions().value_acceleration, 100.0);
}

}  // namespace mimetic
