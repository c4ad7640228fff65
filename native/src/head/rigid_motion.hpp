// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic::head {

/// Where a point of the head is in an image.
struct PointMeasurement {
    Eigen::Vector3d point;        ///< head frame, metres
    Eigen::Vector2d pixel;        ///< of the camera
    Eigen::Matrix2d information;  ///< inverse covariance of the pixel
    double weight = 1;            ///< share of its information that is independent of its neighbours
    Eigen::Vector3d depth_error;  ///< s.d. of the point along its viewing ray, head frame
};

struct RigidMotion {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();  ///< exp(rotation) R, t + translation; the model's error included
    double explained = 0;                  ///< share of inliers among the measurements
    double residual_px = 0;                ///< median
};

/// The pose that best explains measurements: robust (Tukey) Gauss-Newton, finite motion from `start`.
RigidMotion explain_motion(const Camera& camera, const Eigen::Isometry3d& start,
                           const std::vector<PointMeasurement>& measurements);

}  // namespace mimetic::head
