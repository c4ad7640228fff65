// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <mimetic/shared/types.hpp>

namespace mimetic::fit {

/// Parameters: rotation vector and translation of camera_from_head (6), log focal (1), identity (I).
inline constexpr int kPose = 6;

/// Pixel of a point of the head; all by forward-mode differentiation.
template <typename T>
Eigen::Matrix<T, 2, 1> project(const T* pose, const T& log_focal, const T* point,
                               const Eigen::Vector2d& center) {
    T in_camera[3];
    ceres::AngleAxisRotatePoint(pose, point, in_camera);
    for (int k = 0; k < 3; ++k) in_camera[k] += pose[3 + k];
    using std::exp;
    const T focal = exp(log_focal);
    return {focal * in_camera[0] / in_camera[2] + center.x(),
            focal * in_camera[1] / in_camera[2] + center.y()};
}

/// weight * (pixel of (mean + modes identity) - observed); two rows for a point, one for a curve.
class ProjectionResidual : public ceres::CostFunction {
public:
    /// modes: 3 x I; weight: rows x 2, whitens and picks the measured direction
    ProjectionResidual(const Eigen::Vector3d& mean, Eigen::Matrix3Xd modes, const Eigen::Vector2d& observed,
                       Eigen::Matrix<double, Eigen::Dynamic, 2> weight, const Eigen::Vector2d& center)
        : mean_(mean),
          modes_(std::move(modes)),
          observed_(observed),
          weight_(std::move(weight)),
          center_(center) {
        set_num_residuals(static_cast<int>(weight_.rows()));
        *mutable_parameter_block_sizes() = {kPose, 1, static_cast<int>(modes_.cols())};
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const Eigen::Map<const Eigen::VectorXd> identity(parameters[2], modes_.cols());
        const Eigen::Vector3d point = mean_ + modes_ * identity;
        Eigen::Map<Eigen::VectorXd> residual(residuals, weight_.rows());
        if (jacobians == nullptr) {
            residual =
                weight_ * (project(parameters[0], parameters[1][0], point.data(), center_) - observed_);
            return residual.allFinite();
        }
        using Jet = ceres::Jet<double, kPose + 4>;
        Jet pose[kPose], in_head[3];
        for (int k = 0; k < kPose; ++k) pose[k] = Jet(parameters[0][k], k);
        const Jet log_focal(parameters[1][0], kPose);
        for (int k = 0; k < 3; ++k) in_head[k] = Jet(point(k), kPose + 1 + k);
        const Eigen::Matrix<Jet, 2, 1> pixel = project(pose, log_focal, in_head, center_);
        residual = weight_ * (Eigen::Vector2d(pixel(0).a, pixel(1).a) - observed_);
        Eigen::Matrix<double, 2, kPose + 4> derivative;
        derivative << pixel(0).v.transpose(), pixel(1).v.transpose();
        const Eigen::Matrix<double, Eigen::Dynamic, kPose + 4> whitened = weight_ * derivative;
        const auto rows = weight_.rows();
        if (jacobians[0] != nullptr)
            Eigen::Map<MatrixRows>(jacobians[0], rows, kPose) = whitened.leftCols<kPose>();
        if (jacobians[1] != nullptr) Eigen::Map<MatrixRows>(jacobians[1], rows, 1) = whitened.col(kPose);
        if (jacobians[2] != nullptr) {
            Eigen::Map<MatrixRows>(jacobians[2], rows, modes_.cols()) = whitened.rightCols<3>() * modes_;
        }
        return residual.allFinite();
    }

private:
    Eigen::Vector3d mean_;
    Eigen::Matrix3Xd modes_;
    Eigen::Vector2d observed_;
    Eigen::Matrix<double, Eigen::Dynamic, 2> weight_;
    Eigen::Vector2d center_;
};

/// (how far the pixel of mean + modes identity moves between two poses - shift) / sigma.
class MotionResidual : public ceres::CostFunction {
public:
    /// modes: 3 x I; parameters: the two poses, log focal, identity
    MotionResidual(const Eigen::Vector3d& mean, Eigen::Matrix3Xd modes, const Eigen::Vector2d& shift,
                   double sigma, const Eigen::Vector2d& center)
        : mean_(mean), modes_(std::move(modes)), shift_(shift), sigma_(sigma), center_(center) {
        set_num_residuals(2);
        *mutable_parameter_block_sizes() = {kPose, kPose, 1, static_cast<int>(modes_.cols())};
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const Eigen::Map<const Eigen::VectorXd> identity(parameters[3], modes_.cols());
        const Eigen::Vector3d point = mean_ + modes_ * identity;
        Eigen::Map<Eigen::Vector2d> residual(residuals);
        if (jacobians == nullptr) {
            residual = (project(parameters[1], parameters[2][0], point.data(), center_) -
                        project(parameters[0], parameters[2][0], point.data(), center_) - shift_) /
                       sigma_;
            return residual.allFinite();
        }
        constexpr int kFocal = 2 * kPose;
        using Jet = ceres::Jet<double, kFocal + 4>;
        Jet before[kPose], after[kPose], in_head[3];
        for (int k = 0; k < kPose; ++k) before[k] = Jet(parameters[0][k], k);
        for (int k = 0; k < kPose; ++k) after[k] = Jet(parameters[1][k], kPose + k);
        const Jet log_focal(parameters[2][0], kFocal);
        for (int k = 0; k < 3; ++k) in_head[k] = Jet(point(k), kFocal + 1 + k);
        const Eigen::Matrix<Jet, 2, 1> moved =
            project(after, log_focal, in_head, center_) - project(before, log_focal, in_head, center_);
        residual = (Eigen::Vector2d(moved(0).a, moved(1).a) - shift_) / sigma_;
        Eigen::Matrix<double, 2, kFocal + 4> derivative;
        derivative << moved(0).v.transpose(), moved(1).v.transpose();
        derivative /= sigma_;
        if (jacobians[0] != nullptr)
            Eigen::Map<MatrixRows>(jacobians[0], 2, kPose) = derivative.leftCols<kPose>();
        if (jacobians[1] != nullptr)
            Eigen::Map<MatrixRows>(jacobians[1], 2, kPose) = derivative.middleCols<kPose>(kPose);
        if (jacobians[2] != nullptr) Eigen::Map<MatrixRows>(jacobians[2], 2, 1) = derivative.col(kFocal);
        if (jacobians[3] != nullptr)
            Eigen::Map<MatrixRows>(jacobians[3], 2, modes_.cols()) = derivative.rightCols<3>() * modes_;
        return residual.allFinite();
    }

private:
    Eigen::Vector3d mean_;
    Eigen::Matrix3Xd modes_;
    Eigen::Vector2d shift_;
    double sigma_;
    Eigen::Vector2d center_;
};

/// Gaussian prior of the coefficients, and the eyeballs' distance that sets the scale.
class IdentityResidual : public ceres::CostFunction {
public:
    /// between: eye.L - eye.R of the mean; modes: 3 x I of the same difference; distance, tolerance: metres
    IdentityResidual(Eigen::VectorXd spread, const Eigen::Vector3d& between, Eigen::Matrix3Xd modes,
                     double distance, double tolerance)
        : spread_(std::move(spread)),
          between_(between),
          modes_(std::move(modes)),
          distance_(distance),
          tolerance_(tolerance) {
        set_num_residuals(static_cast<int>(spread_.size()) + 1);
        *mutable_parameter_block_sizes() = {static_cast<int>(spread_.size())};
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const auto count = spread_.size();
        const Eigen::Map<const Eigen::VectorXd> identity(parameters[0], count);
        const Eigen::Vector3d between = between_ + modes_ * identity;
        Eigen::Map<Eigen::VectorXd>(residuals, count) = identity.cwiseQuotient(spread_);
        residuals[count] = (between.norm() - distance_) / tolerance_;
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<MatrixRows> jacobian(jacobians[0], count + 1, count);
            jacobian.setZero();
            jacobian.diagonal() = spread_.cwiseInverse();
            jacobian.row(count) = between.normalized().transpose() * modes_ / tolerance_;
        }
        return true;
    }

private:
    Eigen::VectorXd spread_;
    Eigen::Vector3d between_;
    Eigen::Matrix3Xd modes_;
    double distance_;
    double tolerance_;
};

/// Prior of pitch and yaw: a filmed face mostly faces the camera.
struct FacingResidual {
    double pitch_spread;
    double yaw_spread;

    template <typename T>
    bool operator()(const T* pose, T* residuals) const {
        const T forward_in_head[3] = {T(0), T(0), T(1)};
        T forward[3];
        ceres::AngleAxisRotatePoint(pose, forward_in_head, forward);
        // Against the ray to the head, so that a head off the image's centre may face the camera too
        using std::sqrt;
        const T distance = sqrt(pose[3] * pose[3] + pose[4] * pose[4] + pose[5] * pose[5]);
        residuals[0] = (forward[1] + pose[4] / distance) / pitch_spread;
        residuals[1] = (forward[0] + pose[3] / distance) / yaw_spread;
        return true;
    }
};

/// Prior of the focal length's logarithm.
struct FocalResidual {
    double log_focal;
    double spread;

    template <typename T>
    bool operator()(const T* estimate, T* residual) const {
        residual[0] = (estimate[0] - log_focal) / spread;
        return true;
    }
};

}  // namespace mimetic::fit
