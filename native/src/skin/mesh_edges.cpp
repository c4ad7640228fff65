// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_edges.hpp"

#include <algorithm>
#include <tuple>

namespace mimetic {

std::vector<Edge> sorted_edges(TrianglesIn triangles) {
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.rows());
    for (int f = 0; f < triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            edges.push_back({triangles(f, k), triangles(f, (k + 1) % 3), f, k});
        }
    }
    const auto key = [](const Edge& e) {
        return std::tuple(std::min(e.from, e.to), std::max(e.from, e.to), e.face);
    };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
    return edges;
}

std::vector<Edge> boundary_edges(TrianglesIn triangles) {
    const std::vector<Edge> edges = sorted_edges(triangles);
    std::vector<Edge> boundary;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool has_twin = (i > 0 && is_same_edge(edges[i - 1], edges[i])) ||
                              (i + 1 < edges.size() && is_same_edge(edges[i], edges[i + 1]));
        if (!has_twin) {
            boundary.push_back(edges[i]);
        }
    }
    return boundary;
}

}  // namespace mimetic
