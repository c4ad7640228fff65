// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Pinhole camera: x right, y down, z forward; pixels, (0, 0) is the centre of the top-left pixel.
struct Camera {
    double fx = 0;
    double fy = 0;
    double cx = 0;
    double cy = 0;
    int width = 0;
    int height = 0;

    void check() const;  ///< throws InvalidInput: field, value, limit

    /// Pixel of a point in front of the camera (z > 0), metres.
    Eigen::Vector2d project(const Eigen::Vector3d& point_in_camera) const {
        const double inverse_z = 1.0 / point_in_camera.z();
        return {fx * point_in_camera.x() * inverse_z + cx, fy * point_in_camera.y() * inverse_z + cy};
    }

    /// The point that a pixel shows at z = 1; times z, that at another depth.
    Eigen::Vector3d ray(double x, double y) const { return {(x - cx) / fx, (y - cy) / fy, 1}; }

    /// d pixel / d point, pixels a metre.
    Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d& point_in_camera) const {
        const double inverse_z = 1.0 / point_in_camera.z();
        Eigen::Matrix<double, 2, 3> jacobian;
        jacobian << fx * inverse_z, 0, -fx * point_in_camera.x() * inverse_z * inverse_z,  //
            0, fy * inverse_z, -fy * point_in_camera.y() * inverse_z * inverse_z;
        return jacobian;
    }
};

}  // namespace mimetic
