// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/strain.hpp>
#include <string>

namespace mimetic {
namespace {

using Edges = Eigen::Matrix<double, 3, 2>;

constexpr double kLeastSine = 1e-9;  // of the angle between two edges; flatter is no triangle

Edges edges_of(PointsIn vertices, const Eigen::Vector3i& corners) {
    Edges edges;
    edges << (vertices.row(corners[1]) - vertices.row(corners[0])).transpose(),
        (vertices.row(corners[2]) - vertices.row(corners[0])).transpose();
    return edges;
}

/// Area, largest and smallest length, each over its rest and less 1. The squared lengths are the eigenvalues
/// of the right Cauchy-Green tensor.
Eigen::RowVector3d stretch_of(const Eigen::Matrix<double, 3, 2>& gradient) {
    const Eigen::Matrix2d squared = gradient.transpose() * gradient;
    const double mean = squared.trace() / 2;
    const double half_difference = std::hypot((squared(0, 0) - squared(1, 1)) / 2, squared(0, 1));
    const double area = gradient.col(0).cross(gradient.col(1)).norm();
    const double largest = std::sqrt(mean + half_difference);
    return {area - 1, largest - 1, largest > 0 ? area / largest - 1 : -1};
}

}  // namespace

StrainMeter::StrainMeter(PointsIn rest, TrianglesIn triangles) {
    if (!rest.allFinite()) {
        throw InvalidInput("the skin at rest has vertices that are not finite");
    }
    area_around_ = Eigen::VectorXd::Zero(rest.rows());
    elements_.reserve(triangles.rows());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::Vector3i corners = triangles.row(t);
        if (corners.minCoeff() < 0 || corners.maxCoeff() >= rest.rows()) {
            throw InvalidInput("triangle " + std::to_string(t) + " names a vertex outside 0 to " +
                               std::to_string(rest.rows() - 1));
        }
        const Edges edges = edges_of(rest, corners);
        const double length = edges.col(0).norm();
        const double across = edges.col(0).cross(edges.col(1)).norm();  // twice the area
        if (!(across > kLeastSine * length * edges.col(1).norm())) {
            throw InvalidInput("triangle " + std::to_string(t) + " has no area");
        }
        Eigen::Matrix2d in_plane;
        in_plane << length, edges.col(0).dot(edges.col(1)) / length, 0, across / length;
        elements_.push_back({corners, in_plane.inverse(), across / 2});
        for (const int vertex : corners) {
            area_around_[vertex] += across / 2;
        }
    }
}

Points StrainMeter::at_vertices(PointsIn vertices) const {
    if (vertices.rows() != area_around_.size()) {
        throw InvalidInput("got " + std::to_string(vertices.rows()) + " vertices for a skin of " +
                           std::to_string(area_around_.size()));
    }
    Points strain = Points::Zero(vertices.rows(), 3);
    for (const Element& element : elements_) {
        const Eigen::RowVector3d stretch =
            element.area * stretch_of(edges_of(vertices, element.corners) * element.plane_from_edges);
        for (const int vertex : element.corners) {
            strain.row(vertex) += stretch;
        }
    }
    for (Eigen::Index v = 0; v < strain.rows(); ++v) {
        if (area_around_[v] > 0) {
            strain.row(v) /= area_around_[v];
        }
    }
    return strain;
}

}  // namespace mimetic
