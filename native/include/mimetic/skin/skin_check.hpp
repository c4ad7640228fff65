// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Faces that are inverted relative to the faces around them (a vertex is out of place), rising. A sharp
/// crease is not: there, half of the faces around have the same orientation.
std::vector<int> inverted_faces(PointsIn vertices, TrianglesIn triangles);

/// Throws InvalidInput, naming a face of the smallest surplus one, if the boundary has more than
/// `num_openings` closed loops; a head has 1, its neck. triangles_per_face: of the mesh whose faces are
/// named, cut into triangles in order.
void check_openings(TrianglesIn triangles, int num_openings, int triangles_per_face = 1);

}  // namespace mimetic
