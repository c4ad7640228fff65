// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/raster/raster.hpp>
#include <mimetic/retarget/seen_areas.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kHidden = .01;  // of the area of what cannot be seen: it decides where nothing else does
constexpr int kPixels = 1024;    // of a view, its width and height
constexpr double kDepth = 1;     // pixels behind what is seen, that a vertex may lie

using Triangle = std::array<int, 3>;

/// The polygons as fans of triangles, checked.
std::vector<Triangle> fans(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners) {
    require(points.allFinite(), "the points of a mesh must be finite");
    std::vector<Triangle> triangles;
    for (std::size_t face = 0; face < starts.size(); ++face) {
        const int begin = starts[face];
        const int end = face + 1 < starts.size() ? starts[face + 1] : static_cast<int>(corners.size());
        if (begin < 0 || end < begin + 3 || end > static_cast<int>(corners.size())) {
            throw InvalidInput("polygon " + std::to_string(face) +
                               " of the mesh does not have three corners of its own");
        }
        for (int c = begin; c < end; ++c) {
            const int vertex = corners[static_cast<std::size_t>(c)];
            if (vertex < 0 || vertex >= points.rows()) {
                throw InvalidInput("polygon " + std::to_string(face) +
                                   " of the mesh has a corner that is no vertex");
            }
        }
        for (int c = begin + 1; c + 1 < end; ++c) {
            const auto at = static_cast<std::size_t>(c);
            triangles.push_back({corners[static_cast<std::size_t>(begin)], corners[at], corners[at + 1]});
        }
    }
    return triangles;
}

Eigen::Vector3d doubled_normal(PointsIn points, const Triangle& triangle) {
    const Eigen::RowVector3d origin = points.row(triangle[0]);
    return (points.row(triangle[1]) - origin).cross(points.row(triangle[2]) - origin).transpose();
}

Points normals_of(PointsIn points, const std::vector<Triangle>& triangles) {
    Points normals = Points::Zero(points.rows(), 3);
    for (const Triangle& triangle : triangles) {
        const Eigen::Vector3d normal = doubled_normal(points, triangle);
        for (const int vertex : triangle) {
            normals.row(vertex) += normal.transpose();
        }
    }
    return normals;
}

/// Marks the vertices that face a direction and that nothing hides from there.
void look_from(const Eigen::Vector3d& direction, PointsIn points, PointsIn normals,
               const std::vector<Triangle>& triangles, std::vector<bool>& seen) {
    const Eigen::Vector3d aside = direction.unitOrthogonal(), up = direction.cross(aside);
    const Eigen::VectorXd x = points * aside, y = points * up, depth = -points * direction;
    const double extent = std::max(x.maxCoeff() - x.minCoeff(), y.maxCoeff() - y.minCoeff());
    if (!(extent > 0)) {
        return;
    }
    const double pixel = extent / (kPixels - 1);
    const auto place = [&](int v) {
        return Eigen::Vector2d((x[v] - x.minCoeff()) / pixel, (y[v] - y.minCoeff()) / pixel);
    };
    Points2 places(points.rows(), 2);
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        places.row(v) = place(static_cast<int>(v)).transpose();
    }
    Raster nearest(kPixels, kPixels);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        const Eigen::Vector3d depths(depth[a], depth[b], depth[c]);
        fill_triangle(TriangleCorners<double>{places.row(a), places.row(b), places.row(c)}, kPixels, kPixels,
                      [&](int column, int row, const Eigen::Vector3d& weights) {
                          nearest.keep_nearer(column, row, static_cast<int>(t),
                                              static_cast<float>(weights.dot(depths)));
                      });
    }
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const auto at = static_cast<std::size_t>(v);
        if (!seen[at] && normals.row(v).dot(direction) > 0) {
            const auto column = static_cast<int>(std::lround(places(v, 0)));
            const auto row = static_cast<int>(std::lround(places(v, 1)));
            const std::size_t there = nearest.index(column, row);
            const int front = nearest.face[there];
            const bool is_corner =
                front >= 0 && std::ranges::count(triangles[static_cast<std::size_t>(front)], v) > 0;
            seen[at] = is_corner || depth[v] < nearest.depth[there] + kDepth * pixel;
        }
    }
}

}  // namespace

Eigen::VectorXd polygon_areas(PointsIn points, const std::vector<int>& starts,
                              const std::vector<int>& corners) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(points.rows());
    const std::vector<Triangle> triangles = fans(points, starts, corners);
    std::size_t next = 0;
    for (std::size_t face = 0; face < starts.size(); ++face) {
        const auto begin = static_cast<std::size_t>(starts[face]);
        const std::size_t end =
            face + 1 < starts.size() ? static_cast<std::size_t>(starts[face + 1]) : corners.size();
        double doubled = 0;
        for (std::size_t c = begin + 2; c < end; ++c) {
            doubled += doubled_normal(points, triangles[next++]).norm();
        }
        for (std::size_t c = begin; c < end; ++c) {
            areas[corners[c]] += .5 * doubled / static_cast<double>(end - begin);
        }
    }
    return areas;
}

Eigen::VectorXd seen_areas(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners) {
    Eigen::VectorXd areas = polygon_areas(points, starts, corners);
    if (starts.empty()) {
        return areas;
    }
    const std::vector<Triangle> triangles = fans(points, starts, corners);
    const Points normals = normals_of(points, triangles);
    std::vector<bool> seen(static_cast<std::size_t>(points.rows()), false);
    for (int way = 0; way < 27; ++way) {
        const Eigen::Vector3d direction(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1);
        if (!direction.isZero()) {
            look_from(direction.normalized(), points, normals, triangles, seen);
        }
    }
    for (Eigen::Index v = 0; v < areas.size(); ++v) {
        if (!seen[static_cast<std::size_t>(v)]) {
            areas[v] *= kHidden;
        }
    }
    return areas;
}

}  // namespace mimetic
