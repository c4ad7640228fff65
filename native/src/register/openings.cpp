// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <map>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/register/foreign_skin.hpp>

#include "skin/mesh_edges.hpp"

namespace mimetic {
namespace {

constexpr double kSealed =
    .006;                        // m; the way over the seam of a mouth without a slit exceeds the gap by less
constexpr double kSeam = .0025;  // m; skin so near to the seam is soft
constexpr double kSeamEnds = .4;  // of half the mouth's width; there lips are joined on any face
constexpr int kSeamPoints = 41;

/// Boundary edges that are connected, loop by loop in the order of their smallest vertices.
std::vector<std::vector<Edge>> loops_of(TrianglesIn triangles, Eigen::Index num_vertices) {
    const std::vector<Edge> rim = boundary_edges(triangles);
    Components components(num_vertices);
    for (const Edge& edge : rim) {
        components.join(edge.from, edge.to);
    }
    std::map<int, int> smallest;  // of each component
    for (const Edge& edge : rim) {
        const int low = std::min(edge.from, edge.to);
        const auto [entry, is_new] = smallest.try_emplace(components.root(low), low);
        entry->second = std::min(entry->second, low);
    }
    std::map<int, std::vector<Edge>> loops;
    for (const Edge& edge : rim) {
        loops[smallest[components.root(edge.from)]].push_back(edge);
    }
    std::vector<std::vector<Edge>> result;
    result.reserve(loops.size());
    for (auto& [vertex, loop] : loops) {
        result.push_back(std::move(loop));
    }
    return result;
}

/// A point of the line through the mouth's corners and the middle of its slit; along: 0 to 2.
Eigen::RowVector3d on_mouth(PointsIn corners, const Eigen::RowVector3d& middle, double along) {
    return along < 1 ? Eigen::RowVector3d(corners.row(0) + along * (middle - corners.row(0)))
                     : Eigen::RowVector3d(middle + (along - 1) * (corners.row(1) - middle));
}

}  // namespace

std::vector<int> find_holes(const ForeignSkin& skin, const std::vector<bool>& free, PointsIn places,
                            VectorIn reaches) {
    const auto loops = loops_of(skin.triangles, skin.vertices.rows());
    const auto largest = std::max_element(loops.begin(), loops.end(),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    std::vector<int> faces;
    for (auto loop = loops.begin(); loop != loops.end(); ++loop) {
        Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
        bool is_free = true;
        int beside = std::numeric_limits<int>::max();
        for (const Edge& edge : *loop) {
            middle += skin.vertices.row(edge.from) + skin.vertices.row(edge.to);
            is_free = is_free && free[static_cast<std::size_t>(edge.from)] &&
                      free[static_cast<std::size_t>(edge.to)];
            beside = std::min(beside, skin.face[edge.face]);
        }
        middle /= 2 * static_cast<double>(loop->size());
        bool belongs = loop == largest;
        for (Eigen::Index k = 0; k < places.rows(); ++k) {
            belongs = belongs || (middle - places.row(k)).norm() < reaches[k];
        }
        if (!belongs && is_free) {
            faces.push_back(beside);
        }
    }
    return faces;
}

std::vector<bool> find_seam(PointsIn vertices, TrianglesIn triangles, PointsIn inner, PointsIn corners) {
    std::vector<bool> seam(static_cast<std::size_t>(vertices.rows()), false);
    Eigen::Index upper = 0, lower = 0;
    (vertices.rowwise() - inner.row(0)).rowwise().squaredNorm().minCoeff(&upper);
    (vertices.rowwise() - inner.row(1)).rowwise().squaredNorm().minCoeff(&lower);
    const MuscleSurface surface(vertices, triangles,
                                std::vector<bool>(static_cast<std::size_t>(triangles.rows()), true));
    const double way = surface.distances(vertices.row(upper), .1)[lower];
    const double gap = (vertices.row(upper) - vertices.row(lower)).norm();
    if (!(way < 1.25 * gap + kSealed)) {
        return seam;
    }
    const Eigen::RowVector3d middle = (vertices.row(upper) + vertices.row(lower)) / 2;
    const double reach = std::max(kSeam, gap / 2 + .0005);
    for (int i = 0; i < kSeamPoints; ++i) {
        const double along = kSeamEnds + (2 - 2 * kSeamEnds) * i / (kSeamPoints - 1);
        const Eigen::RowVector3d at = on_mouth(corners, middle, along);
        for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
            if ((vertices.row(v) - at).norm() < reach) {
                seam[static_cast<std::size_t>(v)] = true;
            }
        }
    }
    const auto is_in = [&](Eigen::Index t, int k) { return seam[static_cast<std::size_t>(triangles(t, k))]; };
    std::vector<Eigen::Index> touched;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        if (is_in(t, 0) && is_in(t, 1) && is_in(t, 2)) {
            return seam;
        }
        if (is_in(t, 0) || is_in(t, 1) || is_in(t, 2)) {
            touched.push_back(t);
        }
    }
    for (const Eigen::Index t : touched) {  // one row: what lies on both sides of it parts
        for (int k = 0; k < 3; ++k) {
            seam[static_cast<std::size_t>(triangles(t, k))] = true;
        }
    }
    return seam;
}

}  // namespace mimetic
