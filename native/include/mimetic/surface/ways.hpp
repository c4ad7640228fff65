// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Vertices of the shortest path along the edges of quads through some vertices in turn, ends included.
/// Throws InvalidInput where there is none.
std::vector<int> shortest_way(QuadsIn quads, PointsIn vertices, const std::vector<int>& stops);

/// The sphere nearest to points, by algebraic least squares. Throws InvalidInput for fewer than four.
struct Sphere {
    Eigen::Vector3d centre;
    double radius = 0;  ///< metres
};
Sphere nearest_sphere(PointsIn points);

}  // namespace mimetic
