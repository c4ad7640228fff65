// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/curve_noise.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/solve/solve.hpp>

namespace mimetic {

CurveNoise::CurveNoise(int num_frames, double ratio) {
    check_range("number of frames of a curve", num_frames, 3, 2000);
    check_range("ratio of smoothing", ratio, 0, 1000);
    Eigen::VectorXd own = Eigen::VectorXd::Ones(num_frames), next = Eigen::VectorXd::Zero(num_frames);
    const double weight = ratio * ratio;
    for (int i = 0; i + 2 < num_frames; ++i) {
        own.segment<3>(i) += weight * Eigen::Vector3d(1, 4, 1);
        next.segment<2>(i).array() -= 2 * weight;
    }
    pivots_ = below_ = second_below_ = Eigen::VectorXd::Zero(num_frames);
    for (int i = 0; i < num_frames; ++i) {
        double pivot = own[i], coupling = next[i];
        if (i > 0) {
            pivot -= below_[i - 1] * below_[i - 1] * pivots_[i - 1];
            coupling -= second_below_[i - 1] * pivots_[i - 1] * below_[i - 1];
        }
        if (i > 1) {
            pivot -= second_below_[i - 2] * second_below_[i - 2] * pivots_[i - 2];
        }
        pivots_[i] = pivot;
        below_[i] = i + 1 < num_frames ? coupling / pivot : 0;
        second_below_[i] = i + 2 < num_frames ? weight / pivot : 0;
    }
    const Eigen::MatrixXd smoother = smoothed(Eigen::MatrixXd::Identity(num_frames, num_frames));
    const double trace = smoother.squaredNorm();  // of the covariance H H'
    scale_ = std::sqrt(num_frames / trace);
    effective_count_ = trace * trace / smoothed(smoother).squaredNorm();
}

Eigen::MatrixXd CurveNoise::smoothed(const Eigen::Ref<const Eigen::MatrixXd>& curves) const {
    const Eigen::Index count = pivots_.size();
    require(curves.rows() == count, "CurveNoise: curves of another length");
    Eigen::MatrixXd solved = curves;
    for (auto curve : solved.colwise()) {
        for (Eigen::Index i = 1; i < count; ++i) {
            curve[i] -= below_[i - 1] * curve[i - 1] + (i > 1 ? second_below_[i - 2] * curve[i - 2] : 0);
        }
        curve.array() /= pivots_.array();
        for (Eigen::Index i = count - 2; i >= 0; --i) {
            curve[i] -= below_[i] * curve[i + 1] + (i + 2 < count ? second_below_[i] * curve[i + 2] : 0);
        }
    }
    return solved;
}

Eigen::MatrixXd CurveNoise::correlated(const Eigen::Ref<const Eigen::MatrixXd>& normals) const {
    return scale_ * smoothed(normals);
}

double smoothing_ratio(double value_std) {
    // Most of a value's standard deviation is error that stays the same from frame to frame, which the
    // smoother does not see as noise: this share gave the nearest exponents on `mimetic evaluate timing --set
    // tuning`.
    constexpr double kNoiseShare = .5;
    return std::min(kNoiseShare * std::max(0.0, value_std) / SmootherOptions().value_acceleration, 100.0);
}

}  // namespace mimetic
