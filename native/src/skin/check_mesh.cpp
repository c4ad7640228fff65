// SPDX-License-Identifier: GPL-3.0-or-later
#include "check_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_check.hpp>
#include <string>

#include "mesh_edges.hpp"

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
    check_corners(triangles, vertices.rows(), "skin");
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3d a = vertices.row(triangles(f, 0));
        const Eigen::RowVector3d ab = vertices.row(triangles(f, 1)) - a;
        const Eigen::RowVector3d ac = vertices.row(triangles(f, 2)) - a;
        const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ab - ac).squaredNorm()});
        if (!(ab.cross(ac).norm() > 1e-9 * longest)) {
            throw InvalidInput("face " + std::to_string(f) + " has no area: remove it or merge its vertices");
        }
    }
}

/// Corners at a vertex that no shared edge connects: the surface touches itself in a point.
void check_fans(TrianglesIn triangles, Eigen::Index num_vertices, Components& corners) {
    std::vector<int> first(num_vertices, -1);
    for (int i = 0; i < triangles.size(); ++i) {
        int& corner = first[triangles(i / 3, i % 3)];
        if (corner < 0) {
            corner = i;
        } else if (corners.root(corner) != corners.root(i)) {
            throw InvalidInput("face " + std::to_string(i / 3) + " touches face " +
                               std::to_string(corner / 3) + " at vertex " +
                               std::to_string(triangles(i / 3, i % 3)) +
                               " only: give each its own vertex, or join them along an edge");
        }
    }
}

}  // namespace

std::vector<bool> check_mesh(PointsIn vertices, TrianglesIn triangles) {
    check_triangles(vertices, triangles);
    const std::vector<Edge> edges = sorted_edges(triangles);
    std::vector<bool> on_boundary(vertices.rows(), false);
    Components components(triangles.rows());
    Components corners(triangles.size());
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && is_same_edge(edges[i], edges[end])) {
            ++end;
        }
        const auto name = [&] {
            return "the edge " + std::to_string(edges[i].from) + "-" + std::to_string(edges[i].to) +
                   " of face ";
        };
        if (end - i > 2) {
            throw InvalidInput(name() + std::to_string(edges[i + 2].face) +
                               " belongs to more than two faces");
        }
        if (end - i == 1) {
            on_boundary[edges[i].from] = on_boundary[edges[i].to] = true;
        } else if (edges[i].from == edges[i + 1].from) {
            throw InvalidInput(name() + std::to_string(edges[i + 1].face) + " runs the same way in face " +
                               std::to_string(edges[i].face) + ": flip one of them");
        } else {
            const Edge& a = edges[i];
            const Edge& b = edges[i + 1];
            components.join(a.face, b.face);
            corners.join(3 * a.face + a.corner, 3 * b.face + (b.corner + 1) % 3);
            corners.join(3 * a.face + (a.corner + 1) % 3, 3 * b.face + b.corner);
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
    check_fans(triangles, vertices.rows(), corners);
    const auto loose = std::find(used.begin(), used.end(), false);
    if (loose != used.end()) {
        throw InvalidInput("vertex " + std::to_string(loose - used.begin()) + " belongs to no face: drop it");
    }
    if (const std::vector<int> inverted = inverted_faces(vertices, triangles); !inverted.empty()) {
        throw InvalidInput("face " + std::to_string(inverted[0]) +
                           " is turned over among the faces around it: one of its vertices is out of place");
    }
    return on_boundary;
}

}  // namespace mimetic
