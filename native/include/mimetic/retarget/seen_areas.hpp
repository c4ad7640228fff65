// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Each polygon's area in equal parts for the vertices of its corners, square units of the points: V.
/// points: V x 3; starts: F, the first corner of each polygon, ascending; corners: vertices. Throws
/// InvalidInput: a corner that is no vertex, a polygon of fewer than three corners.
Eigen::VectorXd polygon_areas(PointsIn points, const std::vector<int>& starts,
                              const std::vector<int>& corners);

/// The same for what can be seen from outside, from one of 26 directions at least; what cannot (the lining
/// of a shut mouth, eye sockets, the backs of eyeballs and teeth) keeps a hundredth. Polygons show the side
/// from which their corners run counterclockwise.
Eigen::VectorXd seen_areas(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners);

}  // namespace mimetic
