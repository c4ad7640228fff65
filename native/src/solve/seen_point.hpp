// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/rotations.hpp>

namespace mimetic {

/// The pixel of a point of the head, and its derivatives. A step of the pose is a rotation vector about the
/// head's origin, then a shift, both in camera axes.
struct SeenPoint {
    Eigen::Vector3d in_camera;                ///< metres
    Eigen::Matrix<double, 2, 3> by_rotation;  ///< pixels a radian
    Eigen::Matrix<double, 2, 3> by_shift;     ///< pixels a metre
    Eigen::Matrix<double, 2, 3> by_point;     ///< pixels a metre, head frame

    SeenPoint(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
              const Eigen::Vector3d& point_in_head) {
        const Eigen::Vector3d turned = camera_from_head.linear() * point_in_head;
        in_camera = turned + camera_from_head.translation();
        by_shift = camera.project_jacobian(in_camera);
        by_rotation = -by_shift * cross_matrix(turned);
        by_point = by_shift * camera_from_head.linear();
    }
};

}  // namespace mimetic
