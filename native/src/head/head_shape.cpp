// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/QR>
#include <cmath>
#include <mimetic/head/head.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <set>
#include <string>

namespace mimetic {
namespace {

Points used_points(PointsIn vertices, QuadsIn faces) {
    if (!vertices.allFinite()) {
        throw InvalidInput("a vertex of the head is not finite");
    }
    if (faces.rows() == 0 || faces.minCoeff() < 0 || faces.maxCoeff() >= vertices.rows()) {
        throw InvalidInput("the head has no faces, or one names a vertex outside 0 to " +
                           std::to_string(vertices.rows() - 1));
    }
    const std::set<int> used(faces.data(), faces.data() + faces.size());
    Points points(static_cast<Eigen::Index>(used.size()), 3);
    Eigen::Index row = 0;
    for (const int vertex : used) {
        points.row(row++) = vertices.row(vertex);
    }
    return points;
}

/// Algebraic least squares: a x^2 + b y^2 + c z^2 + d y + e z = 1.
void fit_ellipsoid(const Points& points, HeadShape& shape) {
    const Eigen::Index num = points.rows();
    Eigen::MatrixXd terms(num, 5);
    terms << points.array().square().matrix(), points.rightCols<2>();
    const Eigen::VectorXd found = terms.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(num));
    if (num < 6 || !found.allFinite() || found.head<3>().minCoeff() <= 0) {
        throw InvalidInput("no ellipsoid fits the head's skin: give a head that is seen from more sides");
    }
    const Eigen::Vector3d square = found.head<3>();
    shape.centre = {0, -.5 * found[3] / square[1], -.5 * found[4] / square[2]};
    const double level = 1 + shape.centre.cwiseAbs2().dot(square);
    shape.half_axes = (level * square.cwiseInverse()).cwiseSqrt();
    double sum = 0;
    for (Eigen::Index i = 0; i < num; ++i) {
        const Eigen::Vector3d place = points.row(i).transpose() - shape.centre;
        const double radius = place.cwiseQuotient(shape.half_axes).norm();
        sum += std::pow(place.norm() * (1 - 1 / radius), 2);
    }
    shape.depth_error = std::sqrt(sum / static_cast<double>(num));
}

/// The ellipse of the points' extent, at their mean depth.
void fit_plane(const Points& points, HeadShape& shape) {
    const Eigen::Vector3d least = points.colwise().minCoeff(), most = points.colwise().maxCoeff();
    const double middle = .5 * (least.z() + most.z());
    const Eigen::ArrayXd front = (points.col(2).array() > middle).cast<double>();
    const double num = std::max(1., front.sum());
    shape.centre = {0, .5 * (least.y() + most.y()), (front * points.col(2).array()).sum() / num};
    shape.half_axes = .5 * (most - least);
    const Eigen::ArrayXd error = points.col(2).array() - shape.centre.z();
    shape.depth_error = std::sqrt((front * error.square()).sum() / num);
}

}  // namespace

void HeadShape::check() const {
    if (!centre.allFinite()) {
        throw InvalidInput("the head's centre is not finite");
    }
    check_range("head depth_error", depth_error, 0, .1);
    if (model == HeadModel::surface) {
        used_points(vertices, faces);
    } else {
        for (int axis = 0; axis < (model == HeadModel::plane ? 2 : 3); ++axis) {
            check_range("head half_axes " + std::to_string(axis), half_axes[axis], .01, 1);
        }
    }
    for (const MovingPart& part : moving_parts) {
        check_range("head moving part's radius", part.radius, 1e-4, 1);
        check_range("head moving part's share", part.share, 0, 1);
    }
}

HeadShape make_head_shape(HeadModel model, PointsIn vertices, QuadsIn faces) {
    HeadShape shape;
    shape.model = model;
    const Points points = used_points(vertices, faces);
    if (model == HeadModel::ellipsoid) {
        fit_ellipsoid(points, shape);
    } else if (model == HeadModel::plane) {
        fit_plane(points, shape);
    } else {
        shape.vertices = vertices;
        shape.faces = faces;
        constexpr double kFitError = 3e-3;  // metres: proportions from one picture
        shape.depth_error = kFitError;
    }
    constexpr double kLeastError = 1e-3;  // metres: no head is rigid
    shape.depth_error = std::max(shape.depth_error, kLeastError);
    shape.check();
    return shape;
}

void HeadOptions::check() const {
    check_range("head option crop_height", crop_height, 48, 512);
    check_range("head option sample_spacing", sample_spacing, 1, 16);
    check_range("head option max_iterations", max_iterations, 1, 20);
    check_range("head option max_key_views", max_key_views, 0, 200);
    check_range("head option key_view_angle", key_view_angle, .02, 1.5);
    check_range("head option least_facing", least_facing, .05, .9);
    check_range("head option held_quality", held_quality, 0, 1);
    check_range("head option frame_rate", frame_rate, 1e-5, 1e6);
}

}  // namespace mimetic
