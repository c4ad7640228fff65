// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Vertices of a mesh without inverted triangles.
struct Unfolded {
    Points vertices;            ///< N x 3
    std::vector<int> inverted;  ///< faces of the head that were inverted, rising
    double farthest = 0;        ///< m, by which a vertex was moved
};

/// Vertices of inverted triangles go to the mean of their neighbours. split: the mesh's triangles for such
/// vertices; face: T, of the head, for each triangle. Throws InvalidInput, naming a face, if that does not
/// help.
Unfolded unfold(PointsIn vertices, const std::function<Triangles(PointsIn)>& split,
                const Eigen::Ref<const Eigen::VectorXi>& face);

/// Throws InvalidInput on a triangle without area, naming its face. face: T, of the head.
void check_areas(PointsIn vertices, TrianglesIn triangles, const Eigen::Ref<const Eigen::VectorXi>& face);

}  // namespace mimetic
