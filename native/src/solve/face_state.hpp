// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "face_surface.hpp"

namespace mimetic {

/// Pose and values under estimate.
struct FaceState {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    Eigen::VectorXd values;

    void apply(const Eigen::VectorXd& step);  ///< exp(rotation) R, t + translation, values + d
    Eigen::VectorXd difference_from(const FaceState& other) const;  ///< step that leads from other to this
};

/// d frame pixel / d (rotation vector, translation, values) of a point of the head, 2 x (6 + M); modes: 3 x
/// M, those of the point or as a flow shows them.
void skin_jacobian(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                   const Eigen::Vector3d& point_in_head, const Eigen::Matrix3Xf& modes,
                   Eigen::Matrix<float, 2, Eigen::Dynamic>& jacobian, Eigen::Matrix<double, 2, 3>& by_point);

}  // namespace mimetic
