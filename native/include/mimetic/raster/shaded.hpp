// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/overlay.hpp>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// A mesh as it is drawn with plain shading.
struct ShadedMesh {
    Points vertices;      ///< V x 3, metres
    Points normals;       ///< V x 3, unit; either side is lit alike
    Triangles triangles;  ///< T x 3
    Points colours;       ///< T x 3, 0 to 255
};

/// A picture of it, and the triangle that each pixel shows.
struct ShadedPicture {
    ColorImage picture;
    Raster raster;  ///< depth: metres along the camera's z
};

/// Normals at vertices (V x 3), the sums of those of the triangles round each, twice their areas long.
Points area_normals(PointsIn vertices, TrianglesIn triangles);

/// Unit normals at vertices (V x 3), by the area of the triangles round each; 0 where there are none.
Points vertex_normals(PointsIn vertices, TrianglesIn triangles);

/// A point of the camera's frame, of one that is turned to y up and z towards the viewer and lies `distance`
/// metres before the camera; and back.
Eigen::Vector3d across_view(const Eigen::Vector3d& point, double distance);

/// Draws a mesh whose frame is the camera's but turned to y up and z towards the viewer, `distance` metres
/// before the camera. light: unit, from the mesh towards the lamp. Triangles with a corner behind the camera
/// are left out. Throws InvalidInput on an index out of range or a vertex that is not finite.
ShadedPicture draw_shaded(const Camera& camera, const ShadedMesh& mesh, double distance,
                          const Eigen::Vector3d& light);

/// The point of the mesh that a pixel shows, in the mesh's frame; not finite where it shows none.
Eigen::Vector3d shown_point(const Camera& camera, const ShadedMesh& mesh, double distance,
                            const Raster& raster, const Eigen::Vector2d& pixel);

}  // namespace mimetic
