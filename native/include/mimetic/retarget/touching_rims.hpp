// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Two vertices a row.
using VertexPairs = Rows<int, 2>;

/// What a source does to two rims of a mesh.
enum class RimMotion {
    shuts,  ///< they touch at its full value, as lids
    parts,  ///< they touch at rest, as lips that the jaw parts
};

/// Pairs of vertices that shall lie to each other as sources have them.
struct TiedVertices {
    VertexPairs pairs{0, 2};
    Points ways{0, 3};        ///< a unit vector for each pair: what counts is how they move apart along it
    Eigen::VectorXd weights;  ///< one a pair, at least 0
    Eigen::VectorXd open;     ///< one a pair: how far apart they are at rest, along its way
    Eigen::VectorXd pressed;  ///< one a pair, at least 0: how far past touching they are held at most
    Eigen::VectorXi rims;     ///< one a pair, from 0: pairs of the same number lie along the same two rims
    void check(Eigen::Index num_vertices) const;  ///< throws InvalidInput
};

/// Vertices of two rims that touch: those that a source moves most, each with the nearest of those of the
/// same piece of the mesh that it moves little; ways are those in which it parts them, or they part again.
/// Together they weigh as much as the skin that the source moves, lids that it shuts ten times as much: a
/// slit of a millimetre is seen where a millimetre of skin is not. points: V x 3 at rest; starts, corners: of
/// the polygons, as polygon_areas; areas: V, of the vertices; offsets: V x 3 of the source at its full value.
/// Throws InvalidInput.
TiedVertices touching_rims(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners,
                           VectorIn areas, PointsIn offsets, RimMotion motion);

/// Several as one.
TiedVertices joined(const std::vector<TiedVertices>& parts);

}  // namespace mimetic
