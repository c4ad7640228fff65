// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/camera.hpp>

namespace mimetic {

/// Depth map: the nearest surface at each pixel, metres along the camera's z.
struct DepthMap : Raster {
    using Raster::Raster;

    /// Whether a point (metres, camera frame) is in the image and at most `tolerance` metres behind the
    /// surface.
    bool shows(const Camera& camera, const Eigen::Vector3d& point_in_camera, double tolerance) const;
};

/// Depth of a mesh (vertices V x 3, metres, camera frame). Faces with a vertex behind the camera are left
/// out. Throws InvalidInput on an index out of range or a vertex that is not finite.
DepthMap render_depth(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces);

}  // namespace mimetic
