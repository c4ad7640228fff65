// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Where the rays of K pixels meet triangles first.
struct RayHits {
    Eigen::VectorXi triangle;  ///< K; -1: none
    Points weights;            ///< K x 3, of the triangle's corners; 0 where there is none
};

/// The nearest triangle under each pixel among those that face the camera and lie before it.
/// vertices_in_camera: V x 3, metres; triangles: T x 3, counter-clockwise seen from outside. Throws
/// InvalidInput on an index out of range.
RayHits cast_rays(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles, Points2In pixels);

/// Cosine between a triangle's normal and the way to the camera from a point; metres, camera frame.
double facing_cosine(PointsIn vertices_in_camera, const Eigen::RowVector3i& triangle,
                     const Eigen::Vector3d& at);

}  // namespace mimetic
