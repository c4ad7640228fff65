// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/fit/fit.hpp>
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic {

/// Visibility of quads: the edges of those that face the camera.
using Edges = Rows<int, 2>;

/// Edges of the quads that face the camera by more than the cosine `facing`, each once, sorted.
/// vertices_in_camera: V x 3, metres.
Edges facing_edges(PointsIn vertices_in_camera, QuadsIn quads, double facing);

/// The pixels of a canonical picture that show a quad, and the point of it that each shows.
struct CanonicalPixels {
    Eigen::VectorXi pixel;    ///< K, row by row of the picture
    Quads corners;            ///< K x 4 vertices
    Rows<double, 4> weights;  ///< K x 4, sum 1
};

/// The canonical head from the front, orthographic, as large as fits a picture of size x size.
///
/// vertices: V x 3, y up, z to the viewer; quads: what may be shown of it, left out where all four corners
/// are hidden, or facing the viewer by less than the cosine `facing`. is_hidden: V. Throws InvalidInput.
CanonicalPixels canonical_pixels(PointsIn vertices, QuadsIn quads, const std::vector<bool>& is_hidden,
                                 int size, double facing);

/// Colours of a picture at K places of a surface, K x 3, and whether each is seen: inside the picture and
/// facing the camera by more than the cosine `facing`. vertices_in_camera: V x 3, metres.
struct SeenColours {
    Rows<std::uint8_t, 3> colours;  ///< 0 where not seen
    std::vector<bool> is_seen;
};
SeenColours seen_colours(const ColorView& image, const Camera& camera, PointsIn vertices_in_camera,
                         const CanonicalPixels& pixels, double facing);

/// Correlation of a canonical picture (S x S) with its mirror image, -1 to 1: where the fitted rotation is
/// wrong, the halves differ. Brightness and contrast are taken out region by region: light comes from one
/// side. is_seen: S x S.
double mirror_correlation(const ColorView& picture, const std::vector<bool>& is_seen);

}  // namespace mimetic
