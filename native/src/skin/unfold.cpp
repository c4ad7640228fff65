// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_check.hpp>
#include <mimetic/skin/unfold.hpp>
#include <set>
#include <string>

namespace mimetic {
namespace {

constexpr int kMaxRounds = 50;

void check_faces(TrianglesIn triangles, const Eigen::Ref<const Eigen::VectorXi>& face) {
    if (face.size() != triangles.rows()) {
        throw InvalidInput("face has " + std::to_string(face.size()) + " entries for " +
                           std::to_string(triangles.rows()) + " triangles");
    }
}

Points to_mean_of_neighbours(const Points& vertices, const Triangles& triangles,
                             const std::vector<int>& turned) {
    Points sums = Points::Zero(vertices.rows(), 3);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(vertices.rows());
    for (int k = 0; k < 3; ++k) {
        for (const int other : {1, 2}) {
            for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
                sums.row(triangles(t, k)) += vertices.row(triangles(t, (k + other) % 3));
                counts[triangles(t, k)] += 1;
            }
        }
    }
    Points result = vertices;
    for (const int t : turned) {
        for (int k = 0; k < 3; ++k) {
            const int v = triangles(t, k);
            result.row(v) = sums.row(v) / counts[v];
        }
    }
    return result;
}

}  // namespace

Unfolded unfold(PointsIn vertices, const std::function<Triangles(PointsIn)>& split,
                const Eigen::Ref<const Eigen::VectorXi>& face) {
    Unfolded result{vertices, {}, 0};
    std::set<int> inverted;
    std::vector<int> turned;
    for (int round = 0; round <= kMaxRounds; ++round) {
        const Triangles triangles = split(result.vertices);
        check_faces(triangles, face);
        turned = inverted_faces(result.vertices, triangles);
        if (turned.empty()) {
            result.inverted.assign(inverted.begin(), inverted.end());
            result.farthest = (result.vertices - vertices).rowwise().norm().maxCoeff();
            return result;
        }
        for (const int t : turned) {
            inverted.insert(face[t]);
        }
        if (round < kMaxRounds) {
            result.vertices = to_mean_of_neighbours(result.vertices, triangles, turned);
        }
    }
    throw InvalidInput("face " + std::to_string(face[turned[0]]) +
                       " of the head lies turned over among those around it, and smoothing does not help: "
                       "put its vertices back in their place");
}

void check_areas(PointsIn vertices, TrianglesIn triangles, const Eigen::Ref<const Eigen::VectorXi>& face) {
    check_faces(triangles, face);
    check_corners(triangles, vertices.rows(), "head");
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::RowVector3d a = vertices.row(triangles(t, 0));
        const Eigen::RowVector3d ab = vertices.row(triangles(t, 1)) - a;
        const Eigen::RowVector3d ac = vertices.row(triangles(t, 2)) - a;
        const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
        if (!(ab.cross(ac).norm() > 1e-9 * longest)) {
            throw InvalidInput("face " + std::to_string(face[t]) +
                               " of the head has no area: move its vertices apart");
        }
    }
}

}  // namespace mimetic
