// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/raster/raster.hpp>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/retarget/seen_areas.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kHidden = .01;  // of the area of what cannot be seen: it decides where nothing else does
constexpr int kPixels = 1024;    // of a view, its width and height
constexpr double kDepth = 1;     // pixels behind what is seen, that a vertex may lie

/// The polygons as fans of triangles, checked.
Triangles fans(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners) {
    require(points.allFinite(), "the points of a mesh must be finite");
    // As many as there are corners, less two of each polygon
    std::vector<int> triangles;
    triangles.reserve(3 * corners.size());
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
            triangles.insert(triangles.end(),
                             {corners[static_cast<std::size_t>(begin)], corners[at], corners[at + 1]});
        }
    }
    return Eigen::Map<Triangles>(triangles.data(), static_cast<Eigen::Index>(triangles.size() / 3), 3);
}

double doubled_area(PointsIn points, TrianglesIn triangles, Eigen::Index t) {
    const Eigen::RowVector3d origin = points.row(triangles(t, 0));
    return (points.row(triangles(t, 1)) - origin).cross(points.row(triangles(t, 2)) - origin).norm();
}

/// Marks the vertices that face a direction and that nothing hides from there.
void look_from(const Eigen::Vector3d& direction, PointsIn points, PointsIn normals, TrianglesIn triangles,
               std::vector<bool>& seen) {
    const Eigen::Vector3d aside = direction.unitOrthogonal(), up = direction.cross(aside);
    const Eigen::VectorXd x = points * aside, y = points * up, depth = -points * direction;
    const double left = x.minCoeff(), bottom = y.minCoeff();
    const double extent = std::max(x.maxCoeff() - left, y.maxCoeff() - bottom);
    if (!(extent > 0)) {
        return;
    }
    const double pixel = extent / (kPixels - 1);
    Points2 places(points.rows(), 2);
    places << (x.array() - left) / pixel, (y.array() - bottom) / pixel;
    Raster nearest(kPixels, kPixels);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const int a = triangles(t, 0), b = triangles(t, 1), c = triangles(t, 2);
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
            const bool is_corner = front >= 0 && (triangles.row(front).array() == static_cast<int>(v)).any();
            seen[at] = is_corner || depth[v] < nearest.depth[there] + kDepth * pixel;
        }
    }
}

}  // namespace

Eigen::VectorXd polygon_areas(PointsIn points, const std::vector<int>& starts,
                              const std::vector<int>& corners) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(points.rows());
    const Triangles triangles = fans(points, starts, corners);
    Eigen::Index next = 0;
    for (std::size_t face = 0; face < starts.size(); ++face) {
        const auto begin = static_cast<std::size_t>(starts[face]);
        const std::size_t end =
            face + 1 < starts.size() ? static_cast<std::size_t>(starts[face + 1]) : corners.size();
        double doubled = 0;
        for (std::size_t c = begin + 2; c < end; ++c) {
            doubled += doubled_area(points, triangles, next++);
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
    const Triangles triangles = fans(points, starts, corners);
    const Points normals = vertex_normals(points, triangles);
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
