// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/raster/raster.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kNearest = 1e-3;   // metres
constexpr double kOnEdge = 1e-9;    // of a triangle's weights, so that no ray passes between two triangles
constexpr double kEdgeOn = 1e-15;   // m^2, twice the area of a triangle that is seen on edge
constexpr double kTile = 16;        // pixels
constexpr int kTiles = 511;         // along a side: a triangle beside the picture may be far away
constexpr int kParallelCells = 24;  // along a side

void check_triangles(PointsIn vertices, TrianglesIn triangles) {
    if (triangles.size() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices.rows())) {
        throw InvalidInput("a triangle names a vertex outside 0 to " + std::to_string(vertices.rows() - 1));
    }
}

}  // namespace

RayCaster::RayCaster(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles,
                     Points2In pixels)
    : camera_(camera) {
    check_triangles(vertices_in_camera, triangles);
    if (!pixels.allFinite()) {
        throw InvalidInput("a pixel whose ray is asked for is not finite");
    }
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::Vector3d a = vertices_in_camera.row(triangles(t, 0)),
                              b = vertices_in_camera.row(triangles(t, 1)),
                              c = vertices_in_camera.row(triangles(t, 2));
        if (!(std::min({a.z(), b.z(), c.z()}) > kNearest) || !((b - a).cross(c - a).dot(a) < 0)) {
            continue;
        }
        Facet facet;
        facet.triangle = static_cast<int>(t);
        facet.planes << b.cross(c).transpose(), c.cross(a).transpose(), a.cross(b).transpose();
        facet.planes /= a.dot(b.cross(c));
        const Eigen::Vector2d shown[] = {camera.project(a), camera.project(b), camera.project(c)};
        facet.low = shown[0].cwiseMin(shown[1]).cwiseMin(shown[2]);
        facet.high = shown[0].cwiseMax(shown[1]).cwiseMax(shown[2]);
        facets_.push_back(facet);
    }
    if (pixels.rows() > 0) {
        lay_out(pixels.colwise().minCoeff(), pixels.colwise().maxCoeff(), kTile, kTiles);
    }
}

RayCaster::RayCaster(PointsIn vertices, TrianglesIn triangles, Facing facing) : is_parallel_(true) {
    check_triangles(vertices, triangles);
    const double sign = facing == Facing::up ? 1 : -1;
    Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        TriangleCorners<double> seen;
        for (Eigen::Index k = 0; k < 3; ++k) {
            seen[static_cast<std::size_t>(k)] = {vertices(triangles(t, k), 0), vertices(triangles(t, k), 2)};
        }
        const double area = doubled_area(seen);
        // y is up, so what is counter-clockwise in (x, z) faces down
        if (!(sign * area < -kEdgeOn)) {
            continue;
        }
        Facet facet;
        facet.triangle = static_cast<int>(t);
        for (Eigen::Index k = 0; k < 3; ++k) {
            const Eigen::Vector2d &b = seen[static_cast<std::size_t>((k + 1) % 3)],
                                  &c = seen[static_cast<std::size_t>((k + 2) % 3)];
            facet.planes.row(k) << b.y() - c.y(), c.x() - b.x(), b.x() * c.y() - b.y() * c.x();
        }
        facet.planes /= area;
        facet.low = seen[0].cwiseMin(seen[1]).cwiseMin(seen[2]);
        facet.high = seen[0].cwiseMax(seen[1]).cwiseMax(seen[2]);
        low = facets_.empty() ? facet.low : low.cwiseMin(facet.low).eval();
        high = facets_.empty() ? facet.high : high.cwiseMax(facet.high).eval();
        facets_.push_back(facet);
    }
    lay_out(low, high, 1e-9, kParallelCells);
}

void RayCaster::lay_out(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double least_side,
                        int most_cells) {
    origin_ = low;
    const Eigen::Vector2d size = high - low;
    side_ = std::max(least_side, size.maxCoeff() / most_cells);
    columns_ = 1 + static_cast<Eigen::Index>(size.x() / side_);
    rows_ = 1 + static_cast<Eigen::Index>(size.y() / side_);
    cells_.resize(static_cast<std::size_t>(columns_ * rows_));
    for (std::size_t f = 0; f < facets_.size(); ++f) {
        const Eigen::Vector2d first = (facets_[f].low - origin_) / side_,
                              last = (facets_[f].high - origin_) / side_;
        if (last.minCoeff() < 0 || !(first.x() < double(columns_)) || !(first.y() < double(rows_))) {
            continue;
        }
        const std::size_t corner = cell_of(facets_[f].low), end = cell_of(facets_[f].high);
        const auto columns = static_cast<std::size_t>(columns_);
        for (std::size_t row = corner / columns; row <= end / columns; ++row) {
            for (std::size_t column = corner % columns; column <= end % columns; ++column) {
                cells_[row * columns + column].push_back(static_cast<int>(f));
            }
        }
    }
}

std::size_t RayCaster::cell_of(const Eigen::Vector2d& place) const {
    const auto clamped = [](double at, Eigen::Index count) {
        return static_cast<Eigen::Index>(std::clamp(at, 0., static_cast<double>(count - 1)));
    };
    const Eigen::Vector2d at = (place - origin_) / side_;
    return static_cast<std::size_t>(clamped(at.y(), rows_) * columns_ + clamped(at.x(), columns_));
}

RayHit RayCaster::at(const Eigen::Vector2d& place) const {
    const Eigen::Vector3d ray =
        is_parallel_ ? Eigen::Vector3d(place.x(), place.y(), 1) : camera_.ray(place.x(), place.y());
    RayHit hit;
    double nearest = 0;  // 1 / s
    if (cells_.empty()) {
        return hit;
    }
    for (const int f : cells_[cell_of(place)]) {
        const Facet& facet = facets_[static_cast<std::size_t>(f)];
        const Eigen::Vector3d parts = facet.planes * ray;
        const double total = is_parallel_ ? 1 : parts.sum();
        if (std::isfinite(total) && total > nearest && parts.minCoeff() >= -kOnEdge * total) {
            nearest = total;
            hit = {facet.triangle, parts / total};
        }
    }
    return hit;
}

RayHits cast_rays(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles,
                  Points2In pixels) {
    const RayCaster caster(camera, vertices_in_camera, triangles, pixels);
    RayHits hits{Eigen::VectorXi(pixels.rows()), Points(pixels.rows(), 3)};
    for (Eigen::Index k = 0; k < pixels.rows(); ++k) {
        const RayHit hit = caster.at(pixels.row(k).transpose());
        hits.triangle[k] = hit.triangle;
        hits.weights.row(k) = hit.weights.transpose();
    }
    return hits;
}

double facing_cosine(PointsIn vertices_in_camera, const Eigen::RowVector3i& triangle,
                     const Eigen::Vector3d& at) {
    const Eigen::Vector3d a = vertices_in_camera.row(triangle[0]), b = vertices_in_camera.row(triangle[1]),
                          c = vertices_in_camera.row(triangle[2]);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    return -normal.dot(at) / (normal.norm() * at.norm() + 1e-30);
}

}  // namespace mimetic
