// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_edges.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace mimetic {

std::vector<Edge> sorted_edges(TrianglesIn triangles) {
    const auto edge = [&](std::size_t side) {
        const auto f = static_cast<Eigen::Index>(side / 3);
        const int k = static_cast<int>(side % 3);
        return Edge{triangles(f, k), triangles(f, (k + 1) % 3), static_cast<int>(f), k};
    };
    // Both vertices as one number: comparing edges themselves takes three times as long
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(static_cast<std::size_t>(triangles.size()));
    for (std::size_t side = 0; side < order.size(); ++side) {
        const auto [low, high] = std::minmax(
            {static_cast<std::uint32_t>(edge(side).from), static_cast<std::uint32_t>(edge(side).to)});
        order[side] = {std::uint64_t{low} << 32 | high, static_cast<std::uint32_t>(side)};
    }
    std::sort(order.begin(), order.end());
    std::vector<Edge> edges;
    edges.reserve(order.size());
    for (const auto& [vertices, side] : order) {
        edges.push_back(edge(side));
    }
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
