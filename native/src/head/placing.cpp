// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <mimetic/head/placing.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

namespace mimetic {

namespace {

constexpr double kShare = .15;  // of a rotation: s.d. of its error
constexpr double kOwn = .03;    // rad: s.d. beyond that
constexpr double kReach = .5;   // rad of direction: correlation length of that error
constexpr double kLever = .1;   // metres equivalent to a radian

/// N x M: of the offsets at directions N x 3 and M x 3, rotation vectors from the first one.
Eigen::MatrixXd covariance(const Points& a, const Points& b) {
    Eigen::MatrixXd result = kShare * kShare * a * b.transpose();
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
        for (Eigen::Index j = 0; j < b.rows(); ++j) {
            const double apart = (a.row(i) - b.row(j)).squaredNorm();
            result(i, j) += kOwn * kOwn * std::exp(-.5 * apart / (kReach * kReach));
        }
    }
    return result;
}

/// The standard deviation of a reference texture's difference, rad, under which the turns (N x 3) at the
/// directions (N x 3) are most likely.
double most_likely_doubt(const Points& directions, const Points& turns) {
    double best = 0, largest = -std::numeric_limits<double>::infinity();
    for (const double doubt : {.005, .01, .02, .04, .08, .16}) {
        Eigen::MatrixXd spread = covariance(directions, directions);
        spread.diagonal().array() += doubt * doubt;
        const Eigen::PartialPivLU<Eigen::MatrixXd> solver(spread);
        const double weighted = turns.cwiseProduct(solver.solve(turns)).sum();
        const double log_determinant = solver.matrixLU().diagonal().array().abs().log().sum();
        const double likelihood = -.5 * weighted - 1.5 * log_determinant;
        if (likelihood > largest) {
            largest = likelihood;
            best = doubt;
        }
    }
    return best;
}

}  // namespace

std::vector<Eigen::Isometry3d> place_poses(const std::vector<Eigen::Isometry3d>& poses,
                                           const std::vector<PlacedView>& views) {
    if (views.empty()) {
        throw InvalidInput("no reference texture is known on both models: poses cannot be placed");
    }
    const Eigen::Matrix3d first = views.front().on_model.linear().transpose();
    Rotations apart, known, wanted;
    MatrixRows offsets_at_views(views.size(), 6);
    for (std::size_t k = 0; k < views.size(); ++k) {
        const PlacedView& view = views[k];
        apart.push_back(view.on_skin.linear() * view.on_model.linear().transpose());
        known.push_back(view.on_model.linear() * first);
        offsets_at_views.row(static_cast<Eigen::Index>(k)).tail<3>() =
            (view.on_skin.translation() - view.on_model.translation()).transpose() / kLever;
    }
    for (const Eigen::Isometry3d& pose : poses) {
        wanted.push_back(pose.linear() * first);
    }
    const Points turns = rotation_vectors(apart), directions = rotation_vectors(known);
    offsets_at_views.leftCols<3>() = turns;
    Eigen::MatrixXd spread = covariance(directions, directions);
    spread.diagonal().array() += std::pow(most_likely_doubt(directions, turns), 2);
    const MatrixRows offsets =
        covariance(rotation_vectors(wanted), directions) * spread.partialPivLu().solve(offsets_at_views);
    std::vector<Eigen::Isometry3d> placed = poses;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Eigen::Index row = static_cast<Eigen::Index>(i);
        placed[i].linear() = rotation_from_vector(offsets.row(row).head<3>().transpose()) * poses[i].linear();
        placed[i].translation() += kLever * offsets.row(row).tail<3>().transpose();
    }
    return placed;
}

}  // namespace mimetic
