// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/register/lids.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Linear maps (N x 9, rows of 3 x 3) that carry displacements of one surface to another of the same
/// triangles: how the surface round each vertex is turned and stretched [Sumner and Popovic 2004].
Rows<double, 9> surface_maps(PointsIn source, PointsIn target, TrianglesIn triangles);

/// Displacements (N x 3) carried by such maps.
Points carried_by(const Rows<double, 9>& maps, PointsIn displacement);

/// Pairs of points across a slit, at the same shares of its length.
struct RimPairs {
    Points upper;  ///< K x 3
    Points lower;  ///< K x 3
};

/// upper, lower: points of the rims in any order; corners: 2 x 3, ends of the slit, which are in no pair.
RimPairs rim_pairs(PointsIn upper, PointsIn lower, PointsIn corners, int count);

/// How a slit is closed.
struct SlitOptions {
    double upper_share = .5;  ///< of the way, that the upper rim goes
    double reach = .015;      ///< m along the skin, over which the correction fades
    bool keeps_gap = true;    ///< the rims come as near as they are at rest; false: they meet
    void check() const;       ///< throws InvalidInput: field, value, limit
};

/// A displacement (N x 3) of the skin of a surface, with the smoothest correction by which the rims of a slit
/// close: the least second differences over the skin that is nearer than the reach. Skin that is outside of
/// an eye at rest, vertices and middles of edges, stays outside. slit: K places on the skin in pairs.
Points close_slit(const MuscleSurface& surface, PointsIn displacement, const SlitPlaces& slit,
                  const SlitOptions& options, const EyeSurface& eye = {});

/// Distances between the displaced rims, K, metres.
Eigen::VectorXd rim_gaps(PointsIn vertices, PointsIn displacement, const SlitPlaces& slit);

}  // namespace mimetic
