// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>
#include <optional>
#include <vector>

namespace mimetic {

constexpr double kCovered = 2e-3;  ///< metres behind a surface that still count as visible

/// The points of a surface that K pixels show.
struct SurfacePlaces {
    std::vector<bool> on_face;  ///< K; pixels off the face get the nearest skin
    Eigen::VectorXi triangle;   ///< K
    Points weights;             ///< K x 3, of the triangle's corners
    Points2 offset;             ///< K x 2, pixels from the place to the pixel; 0 except at outlines
};

/// The two triangles of each quad: all first halves (0, 1, 2), then all second ones (0, 2, 3).
Triangles triangles_of(QuadsIn quads);

/// The place on a fitted head's surface that each pixel (K x 2) shows; empty if no skin faces the camera.
///
/// Where the surface turns away or is occluded, the intersection with a pixel's ray is unstable: far down the
/// throat between two lips, on the neck beside the chin, far back on a temple. What the pixel shows there is,
/// within the fit's error, the nearest skin that faces the camera; at the outline, the median in depth of the
/// intersections of rays around it. vertices_in_camera: V x 3, metres, of facets of a millimetre or two;
/// faces: F x 4. Throws InvalidInput on an index out of range or a vertex that is not finite.
std::optional<SurfacePlaces> places_under(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces,
                                          Points2In pixels);

}  // namespace mimetic
