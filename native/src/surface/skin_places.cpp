// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/nearest.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <string>

namespace mimetic {
namespace {

/// Of the foot of a point in a triangle's plane.
Eigen::RowVector3d plane_weights(const Eigen::RowVector3d& arm, const Eigen::RowVector3d& ab,
                                 const Eigen::RowVector3d& ac) {
    const double aa = ab.squaredNorm(), bb = ac.squaredNorm(), across = ab.dot(ac);
    const double ua = arm.dot(ab), ub = arm.dot(ac);
    const double scale = std::max(aa * bb - across * across, 1e-30);
    const double v = (bb * ua - across * ub) / scale, w = (aa * ub - across * ua) / scale;
    return {1 - v - w, v, w};
}

Eigen::Matrix3d corners_of(PointsIn vertices, const Eigen::RowVector3i& triangle) {
    Eigen::Matrix3d corners;
    corners << vertices.row(triangle[0]), vertices.row(triangle[1]), vertices.row(triangle[2]);
    return corners;
}

}  // namespace

MatrixRows SkinPlaces::values(MatrixIn at_vertices) const {
    check_corners(corners, at_vertices.rows(), "surface with values");
    require(weights.rows() == corners.rows(), "each place needs weights of its corners");
    MatrixRows result(corners.rows(), at_vertices.cols());
    for (Eigen::Index i = 0; i < corners.rows(); ++i) {
        result.row(i) = weights(i, 0) * at_vertices.row(corners(i, 0)) +
                        weights(i, 1) * at_vertices.row(corners(i, 1)) +
                        weights(i, 2) * at_vertices.row(corners(i, 2));
    }
    return result;
}

Points SkinPlaces::positions(PointsIn vertices, double lift) const {
    Points result = values(vertices);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        const Eigen::RowVector3d a = vertices.row(corners(i, 0));
        const Eigen::RowVector3d outwards =
            (vertices.row(corners(i, 1)) - a).cross(vertices.row(corners(i, 2)) - a);
        result.row(i) += lift * outwards / std::max(outwards.norm(), 1e-12);
    }
    return result;
}

Eigen::RowVector3d closest_weights(const Eigen::RowVector3d& point, const Eigen::Matrix3d& corners) {
    const Eigen::RowVector3d a = corners.row(0);
    const Eigen::RowVector3d inside = plane_weights(point - a, corners.row(1) - a, corners.row(2) - a);
    Eigen::RowVector3d best = inside.minCoeff() >= 0 ? inside : Eigen::RowVector3d(1, 0, 0);
    double least = (best * corners - point).norm();
    for (int start = 0; start < 3; ++start) {
        const int end = (start + 1) % 3;
        const Eigen::RowVector3d edge = corners.row(end) - corners.row(start);
        const double along =
            std::clamp((point - corners.row(start)).dot(edge) / std::max(edge.squaredNorm(), 1e-18), 0., 1.);
        Eigen::RowVector3d weights = Eigen::RowVector3d::Zero();
        weights[start] = 1 - along;
        weights[end] = along;
        if (const double gap = (weights * corners - point).norm(); gap < least) {
            least = gap;
            best = weights;
        }
    }
    return best;
}

TrianglesAround::TrianglesAround(TrianglesIn triangles, int num_vertices)
    : triangles_(triangles),
      first_(static_cast<std::size_t>(num_vertices) + 1, 0),
      around_(static_cast<std::size_t>(triangles.size())) {
    if (triangles.size() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= num_vertices)) {
        throw InvalidInput("a triangle names a vertex outside 0 to " + std::to_string(num_vertices - 1));
    }
    for (Eigen::Index i = 0; i < triangles.size(); ++i) {
        ++first_[static_cast<std::size_t>(triangles(i / 3, i % 3)) + 1];
    }
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) {
        if (first_[v + 1] > 0) {
            used_.push_back(static_cast<int>(v));
        }
        first_[v + 1] += first_[v];
    }
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index i = 0; i < triangles.size(); ++i) {
        const auto vertex = static_cast<std::size_t>(triangles(i / 3, i % 3));
        around_[static_cast<std::size_t>(next[vertex]++)] = static_cast<int>(i / 3);
    }
}

SkinPlaces TrianglesAround::closest(PointsIn points, const Eigen::VectorXi& near, PointsIn vertices) const {
    SkinPlaces places{Triangles(points.rows(), 3), Points(points.rows(), 3), Eigen::VectorXd(points.rows())};
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const auto vertex = static_cast<std::size_t>(near[i]);
        if (vertex + 1 >= first_.size() || first_[vertex] == first_[vertex + 1]) {
            throw InvalidInput("no triangle is at vertex " + std::to_string(near[i]));
        }
        double least = std::numeric_limits<double>::infinity();
        for (int k = first_[vertex]; k < first_[vertex + 1]; ++k) {
            const Eigen::RowVector3i triangle = triangles_.row(around_[static_cast<std::size_t>(k)]);
            const Eigen::Matrix3d corners = corners_of(vertices, triangle);
            const Eigen::RowVector3d weights = closest_weights(points.row(i), corners);
            const double gap = (weights * corners - points.row(i)).norm();
            if (k == first_[vertex] || gap < least) {
                least = gap;
                places.corners.row(i) = triangle;
                places.weights.row(i) = weights;
                places.gaps[i] = gap;
            }
        }
    }
    return places;
}

SkinPlaces nearest_places(PointsIn points, PointsIn vertices, TrianglesIn triangles) {
    const TrianglesAround around(triangles, static_cast<int>(vertices.rows()));
    const Points outer = vertices(around.used(), Eigen::all);
    Eigen::VectorXi near = NearestPoints(outer).find(points);
    for (int& vertex : near) {
        vertex = around.used()[static_cast<std::size_t>(vertex)];
    }
    return around.closest(points, near, vertices);
}

}  // namespace mimetic
