// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Throws InvalidInput unless the triangles form one connected, consistently oriented manifold with areas,
/// none inverted, and every vertex belongs to one. Returns true for each vertex on the boundary.
std::vector<bool> check_mesh(PointsIn vertices, TrianglesIn triangles);

}  // namespace mimetic
