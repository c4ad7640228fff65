// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <span>
#include <vector>

namespace mimetic {

/// Some of N vertices for each of N vertices, rising.
struct VertexLists {
    std::vector<int> start;   ///< N + 1
    std::vector<int> vertex;  ///< of all lists in turn

    int size() const { return static_cast<int>(start.size()) - 1; }
    std::span<const int> of(int v) const {
        return {vertex.data() + start[v], static_cast<std::size_t>(start[v + 1] - start[v])};
    }
    /// Index in `vertex` of one that v's list has.
    int place(int v, int other) const;
};

/// Each vertex and those that share a triangle with it.
VertexLists vertex_rings(TrianglesIn triangles, Eigen::Index num_vertices);

/// Each vertex's ring, and the rings of those in it.
VertexLists second_rings(const VertexLists& rings);

/// A symmetric matrix over the displacements of vertices: 3 x 3 blocks, both triangles.
struct BlockRows {
    explicit BlockRows(VertexLists structure)
        : columns(std::move(structure)), blocks(columns.vertex.size(), Eigen::Matrix3d::Zero()) {}

    VertexLists columns;                  ///< of the blocks in each row
    std::vector<Eigen::Matrix3d> blocks;  ///< as columns.vertex

    /// The block of two vertices, which the structure must have.
    Eigen::Matrix3d& at(int row, int column) {
        return blocks[static_cast<std::size_t>(columns.place(row, column))];
    }
};

}  // namespace mimetic
