// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "face_surface.hpp"

namespace mimetic {

/// A small change of pose and values, 6 + M numbers in one vector, as the solvers have it.
struct FaceStep {
    static constexpr Eigen::Index kPose = 6;  ///< numbers before the values

    Eigen::VectorXd flat;

    FaceStep() = default;
    explicit FaceStep(Eigen::VectorXd numbers) : flat(std::move(numbers)) {}
    static FaceStep none(Eigen::Index num_values) {
        return FaceStep(Eigen::VectorXd::Zero(kPose + num_values));
    }

    auto rotation() const { return flat.head<3>(); }         ///< vector, rad, camera axes
    auto translation() const { return flat.segment<3>(3); }  ///< metres, camera axes
    auto values() const { return flat.tail(flat.size() - kPose); }
    auto rotation() { return flat.head<3>(); }
    auto translation() { return flat.segment<3>(3); }
    auto values() { return flat.tail(flat.size() - kPose); }
};

/// Pose and values under estimate.
struct FaceState {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    Eigen::VectorXd values;

    void apply(const FaceStep& step);                        ///< exp(rotation) R, t + translation, values + d
    FaceStep difference_from(const FaceState& other) const;  ///< step that leads from other to this
    void keep_within(const FaceMotion& motion);              ///< values to their bounds
};

/// d frame pixel / d (rotation vector, translation, values) of a point of the head, 2 x (6 + M); modes: 3 x
/// M, those of the point or as a flow shows them.
void skin_jacobian(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                   const Eigen::Vector3d& point_in_head, const Eigen::Matrix3Xf& modes,
                   Eigen::Matrix<float, 2, Eigen::Dynamic>& jacobian, Eigen::Matrix<double, 2, 3>& by_point);

}  // namespace mimetic
