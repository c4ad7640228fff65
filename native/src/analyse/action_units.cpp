// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <mimetic/analyse/action_units.hpp>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

Eigen::MatrixXd distances(PointsIn points, const Points& centers) {
    Eigen::MatrixXd table(points.rows(), centers.rows());
    for (Eigen::Index k = 0; k < centers.rows(); ++k) {
        table.col(k) = (points.rowwise() - centers.row(k)).rowwise().norm();
    }
    return table;
}

void check_field(PointsIn vertices, const std::vector<bool>& is_skin, double radius) {
    require(is_skin.size() == static_cast<std::size_t>(vertices.rows()),
            "is_skin must have an entry for each vertex");
    check_range("radius of an action unit's points", radius, 1e-6, 10);
}

/// V x K, 0 off the skin.
Eigen::MatrixXd nearness(PointsIn vertices, const std::vector<bool>& is_skin, PointsIn places,
                         double radius) {
    Eigen::MatrixXd table = (1 - distances(vertices, places).array() / radius).cwiseMax(0);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        if (!is_skin[static_cast<std::size_t>(v)]) {
            table.row(v).setZero();
        }
    }
    return table;
}

}  // namespace

PointWarp::PointWarp(PointsIn from, PointsIn to) : from_(from) {
    const Eigen::Index count = from.rows();
    require(count >= 5 && to.rows() == count && from.allFinite() && to.allFinite(),
            "a warp needs 5 points or more, as many on the head as in the model");
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 4, count + 4);
    system.topLeftCorner(count, count) = distances(from, from_);
    system.block(0, count, count, 1).setOnes();
    system.block(0, count + 1, count, 3) = from;
    system.bottomLeftCorner(4, count) = system.topRightCorner(count, 4).transpose();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + 4, 3);
    right.topRows(count) = to;
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(system);
    require(factor.isInvertible(), "the points of a warp coincide or lie in a plane");
    weights_ = factor.solve(right);
}

Points PointWarp::operator()(PointsIn points) const {
    const Eigen::Index count = from_.rows();
    Points warped = distances(points, from_) * weights_.topRows(count) + points * weights_.bottomRows(3);
    warped.rowwise() += weights_.row(count);
    return warped;
}

Points displacement_about(PointsIn vertices, const std::vector<bool>& is_skin, PointsIn places,
                          PointsIn displacements, double radius) {
    check_field(vertices, is_skin, radius);
    require(displacements.rows() == places.rows(), "each place needs a displacement");
    const Eigen::MatrixXd near = nearness(vertices, is_skin, places, radius);
    Points field = near * displacements;
    // Of one point alone the nearness itself; of several the mean, faded as the nearest one fades
    const Eigen::VectorXd sum = near.rowwise().sum().cwiseMax(1e-12);
    const Eigen::VectorXd largest = near.rowwise().maxCoeff();
    return largest.cwiseQuotient(sum).asDiagonal() * field;
}

Eigen::VectorXd nearness_to(PointsIn vertices, const std::vector<bool>& is_skin, PointsIn places,
                            double radius) {
    check_field(vertices, is_skin, radius);
    require(places.rows() > 0, "nearness needs a place");
    return nearness(vertices, is_skin, places, radius).rowwise().maxCoeff();
}

Eigen::VectorXd left_share(PointsIn vertices, double margin) {
    check_range("margin between the sides", margin, 1e-6, 1);
    Eigen::VectorXd shares(vertices.rows());
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        shares[v] = smooth_step(.5 + .5 * vertices(v, 0) / margin);
    }
    return shares;
}

}  // namespace mimetic
