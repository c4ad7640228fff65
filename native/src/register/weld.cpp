// SPDX-License-Identifier: GPL-3.0-or-later
#include "weld.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "skin/mesh_edges.hpp"

namespace mimetic {

Welded weld(const Points& points) {
    std::vector<int> order(static_cast<std::size_t>(points.rows()));
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int i) { return std::tuple(points(i, 0), points(i, 1), points(i, 2)); };
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return std::tuple(place(a), a) < std::tuple(place(b), b); });
    Welded welded{{}, std::vector<int>(order.size())};
    for (const int i : order) {
        if (welded.kept.empty() || place(welded.kept.back()) != place(i)) {
            welded.kept.push_back(i);
        }
        welded.number[static_cast<std::size_t>(i)] = static_cast<int>(welded.kept.size()) - 1;
    }
    return welded;
}

std::vector<int> parts_of(const Triangles& triangles, std::size_t num_vertices) {
    Components components(static_cast<Eigen::Index>(num_vertices));
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        components.join(triangles(t, 0), triangles(t, 1));
        components.join(triangles(t, 1), triangles(t, 2));
    }
    std::vector<int> smallest(num_vertices, -1), part(num_vertices);
    for (std::size_t v = 0; v < num_vertices; ++v) {
        int& label = smallest[static_cast<std::size_t>(components.root(static_cast<int>(v)))];
        label = label < 0 ? static_cast<int>(v) : label;
        part[v] = label;
    }
    return part;
}

}  // namespace mimetic
