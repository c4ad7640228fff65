// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/shaded.hpp>
#include <mimetic/shared/similarity.hpp>
#include <vector>

namespace mimetic {

/// A head's mesh as the networks are shown it: vertices at the same place joined, so that shading is smooth;
/// what is round as an eyeball is white, and loose sheets (lashes, brows, hair) are left out.
struct ShownHead {
    ShadedMesh mesh;
    std::vector<int> part;     ///< T, the connected part of each triangle, by a vertex of it
    std::vector<bool> is_eye;  ///< T, whether it is of an eyeball

    ShownHead aligned(const Similarity& target_from_mesh) const;
};

/// vertices: V x 3, any unit and axes. Throws InvalidInput without triangles, on an index out of range or a
/// vertex that is not finite.
ShownHead shown_head(PointsIn vertices, TrianglesIn triangles);

}  // namespace mimetic
