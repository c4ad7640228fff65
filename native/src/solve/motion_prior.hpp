// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <mimetic/solve.hpp>

namespace mimetic {

/// Covariance of the values about rest, M squared: the two sides of a face mostly act together.
Eigen::MatrixXd rest_covariance(const FaceMotion& motion);

/// What the rest prior tells in one frame: a state lasts for several, and each must not count it in full.
Eigen::MatrixXd rest_information(const FaceMotion& motion);

/// A prior for few active values that leaves the active ones alone, about the present ones: pull and
/// information to add for the M values. std: how well each is known.
struct Sparsity {
    Eigen::VectorXd pull;
    Eigen::VectorXd information;
};
Sparsity sparsity_at(const FaceMotion& motion, const Eigen::VectorXd& values, const Eigen::VectorXd& likely,
                     const Eigen::VectorXd& std, double dead_zone);

}  // namespace mimetic
