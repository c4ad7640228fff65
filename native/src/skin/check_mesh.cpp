// SPDX-License-Identifier: GPL-3.0-or-later
#include "check_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <mimetic/error.hpp>
#include <numeric>
#include <string>

namespace mimetic {
namespace {

void check_triangles(PointsIn vertices, TrianglesIn triangles) {
    if (triangles.rows() == 0) {
        throw InvalidInput("the skin has no faces");
    }
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        if (!vertices.row(v).allFinite()) {
            throw InvalidInput("vertex " + std::to_string(v) + " is not finite");
        }
    }
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            if (triangles(f, k) < 0 || triangles(f, k) >= vertices.rows()) {
                throw InvalidInput("face " + std::to_string(f) + " names vertex " +
                                   std::to_string(triangles(f, k)) + ", the skin has " +
                                   std::to_string(vertices.rows()) + " vertices");
            }
        }
        const Eigen::RowVector3d a = vertices.row(triangles(f, 0));
        const Eigen::RowVector3d ab = vertices.row(triangles(f, 1)) - a;
        const Eigen::RowVector3d ac = vertices.row(triangles(f, 2)) - a;
        const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ab - ac).squaredNorm()});
        if (!(ab.cross(ac).norm() > 1e-9 * longest)) {
            throw InvalidInput("face " + std::to_string(f) + " has no area: remove it or merge its vertices");
        }
    }
}

struct Edge {
    int from;
    int to;
    int face;
};

std::vector<Edge> sorted_edges(TrianglesIn triangles) {
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.rows());
    for (int f = 0; f < triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            edges.push_back({triangles(f, k), triangles(f, (k + 1) % 3), f});
        }
    }
    const auto key = [](const Edge& e) { return std::pair(std::min(e.from, e.to), std::max(e.from, e.to)); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
    return edges;
}

bool is_same_edge(const Edge& a, const Edge& b) {
    return (a.from == b.from && a.to == b.to) || (a.from == b.to && a.to == b.from);
}

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

}  // namespace

std::vector<bool> check_mesh(PointsIn vertices, TrianglesIn triangles) {
    check_triangles(vertices, triangles);
    const std::vector<Edge> edges = sorted_edges(triangles);
    std::vector<bool> on_boundary(vertices.rows(), false);
    Components components(triangles.rows());
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && is_same_edge(edges[i], edges[end])) {
            ++end;
        }
        const std::string name =
            "the edge " + std::to_string(edges[i].from) + "-" + std::to_string(edges[i].to) + " of face ";
        if (end - i > 2) {
            throw InvalidInput(name + std::to_string(edges[i + 2].face) + " belongs to more than two faces");
        }
        if (end - i == 1) {
            on_boundary[edges[i].from] = on_boundary[edges[i].to] = true;
        } else if (edges[i].from == edges[i + 1].from) {
            throw InvalidInput(name + std::to_string(edges[i + 1].face) + " runs the same way in face " +
                               std::to_string(edges[i].face) + ": flip one of them");
        } else {
            components.join(edges[i].face, edges[i + 1].face);
        }
        i = end;
    }
    std::vector<bool> used(vertices.rows(), false);
    for (int f = 0; f < triangles.rows(); ++f) {
        if (components.root(f) != components.root(0)) {
            throw InvalidInput("face " + std::to_string(f) + " is a loose part: the skin must be one piece");
        }
        used[triangles(f, 0)] = used[triangles(f, 1)] = used[triangles(f, 2)] = true;
    }
    const auto loose = std::find(used.begin(), used.end(), false);
    if (loose != used.end()) {
        throw InvalidInput("vertex " + std::to_string(loose - used.begin()) + " belongs to no face: drop it");
    }
    return on_boundary;
}

}  // namespace mimetic
