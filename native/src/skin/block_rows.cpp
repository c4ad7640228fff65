// SPDX-License-Identifier: GPL-3.0-or-later
#include "block_rows.hpp"

#include <algorithm>

namespace mimetic {
namespace {

/// Collects each vertex's list by `visit(v, add)`, in which add(other) adds one once.
template <typename Visit>
VertexLists collect(int num_vertices, std::size_t expected, const Visit& visit) {
    VertexLists lists;
    lists.start.reserve(static_cast<std::size_t>(num_vertices) + 1);
    lists.start.push_back(0);
    lists.vertex.reserve(expected);
    std::vector<int> last(static_cast<std::size_t>(num_vertices), -1);
    for (int v = 0; v < num_vertices; ++v) {
        visit(v, [&](int other) {
            if (last[other] != v) {
                last[other] = v;
                lists.vertex.push_back(other);
            }
        });
        std::sort(lists.vertex.begin() + lists.start.back(), lists.vertex.end());
        lists.start.push_back(static_cast<int>(lists.vertex.size()));
    }
    return lists;
}

}  // namespace

VertexLists vertex_rings(TrianglesIn triangles, Eigen::Index num_vertices) {
    std::vector<int> start(static_cast<std::size_t>(num_vertices) + 1, 0);
    for (const int v : triangles.reshaped()) {
        ++start[v + 1];
    }
    for (std::size_t v = 1; v < start.size(); ++v) {
        start[v] += start[v - 1];
    }
    std::vector<int> face(static_cast<std::size_t>(triangles.size())), next = start;
    for (int f = 0; f < triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            face[next[triangles(f, k)]++] = f;
        }
    }
    const std::size_t expected = static_cast<std::size_t>(8 * num_vertices);
    return collect(static_cast<int>(num_vertices), expected, [&](int v, const auto& add) {
        for (int i = start[v]; i < start[v + 1]; ++i) {
            for (int k = 0; k < 3; ++k) {
                add(triangles(face[i], k));
            }
        }
    });
}

VertexLists second_rings(const VertexLists& rings) {
    return collect(rings.size(), 3 * rings.vertex.size(), [&](int v, const auto& add) {
        for (const int neighbour : rings.of(v)) {
            for (const int other : rings.of(neighbour)) {
                add(other);
            }
        }
    });
}

int VertexLists::place(int v, int other) const {
    const std::span<const int> list = of(v);
    return start[v] + static_cast<int>(std::lower_bound(list.begin(), list.end(), other) - list.begin());
}

}  // namespace mimetic
