// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <numeric>
#include <vector>

namespace mimetic {

/// A side of a face, along its winding.
struct Edge {
    int from;
    int to;
    int face;
    int corner;  ///< of the face, where the side starts
};

/// All sides, those between the same vertices next to each other, in the order of the faces.
std::vector<Edge> sorted_edges(TrianglesIn triangles);

inline bool is_same_edge(const Edge& a, const Edge& b) {
    return (a.from == b.from && a.to == b.to) || (a.from == b.to && a.to == b.from);
}

/// Sides that belong to one face only.
std::vector<Edge> boundary_edges(TrianglesIn triangles);

/// Connected components, by union and find.
class Components {
public:
    explicit Components(Eigen::Index size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }
    int root(int i) {
        while (parent_[i] != i) {
            i = parent_[i] = parent_[parent_[i]];
        }
        return i;
    }
    void join(int i, int j) { parent_[root(i)] = root(j); }

private:
    std::vector<int> parent_;
};

}  // namespace mimetic
