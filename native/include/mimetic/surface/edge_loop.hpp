// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Vertices of a mesh of quads met by going straight on from a vertex over a neighbour, both included: across
/// every vertex of valence four. Ends at any other vertex, or before one repeats.
/// faces: F x 4. Throws InvalidInput unless both are ends of one edge.
std::vector<int> edge_loop(QuadsIn faces, int from, int over);

}  // namespace mimetic
