// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_check.hpp>
#include <string>

#include "mesh_edges.hpp"

namespace mimetic {

std::vector<int> inverted_faces(PointsIn vertices, TrianglesIn triangles) {
    constexpr double kAgainst = -0.9;  // cosine to the mean of the faces around
    check_corners(triangles, vertices.rows(), "skin");
    Points normals(triangles.rows(), 3);
    Points around = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3d a = vertices.row(triangles(f, 0));
        const Eigen::RowVector3d ab = vertices.row(triangles(f, 1)) - a;
        normals.row(f) = ab.cross(Eigen::RowVector3d(vertices.row(triangles(f, 2)) - a));
        for (int k = 0; k < 3; ++k) {
            around.row(triangles(f, k)) += normals.row(f);
        }
    }
    std::vector<int> inverted;
    for (int f = 0; f < triangles.rows(); ++f) {
        Eigen::RowVector3d ring = -3 * normals.row(f);
        for (int k = 0; k < 3; ++k) {
            ring += around.row(triangles(f, k));
        }
        if (normals.row(f).dot(ring) < kAgainst * normals.row(f).norm() * ring.norm()) {
            inverted.push_back(f);
        }
    }
    return inverted;
}

void check_openings(TrianglesIn triangles, int num_openings, int triangles_per_face) {
    if (num_openings < 0 || triangles_per_face < 1) {
        throw InvalidInput("num_openings is " + std::to_string(num_openings) + " and triangles_per_face " +
                           std::to_string(triangles_per_face) + ", needed are at least 0 and 1");
    }
    require(triangles.size() == 0 || triangles.minCoeff() >= 0, "a face of the skin names a vertex below 0");
    const std::vector<Edge> boundary = boundary_edges(triangles);
    Components loops(triangles.size() == 0 ? 0 : triangles.maxCoeff() + 1);
    for (const Edge& edge : boundary) {
        loops.join(edge.from, edge.to);
    }
    std::map<int, std::vector<int>> faces_by_loop;
    for (const Edge& edge : boundary) {
        faces_by_loop[loops.root(edge.from)].push_back(edge.face);
    }
    const int found = static_cast<int>(faces_by_loop.size());
    if (found <= num_openings) {
        return;
    }
    const auto smallest =
        std::min_element(faces_by_loop.begin(), faces_by_loop.end(),
                         [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    const int face = *std::min_element(smallest->second.begin(), smallest->second.end());
    throw InvalidInput("the skin has " + std::to_string(found) + " openings, " +
                       std::to_string(num_openings) + " belong there; the smallest has " +
                       std::to_string(smallest->second.size()) + " edges and lies at face " +
                       std::to_string(face / triangles_per_face) + ": fill it");
}

}  // namespace mimetic
