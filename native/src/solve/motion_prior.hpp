// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <mimetic/solve/solve.hpp>

namespace mimetic {

/// Throws InvalidInput unless the motion's correlation is empty or one of its values.
void check_correlation(const FaceMotion& motion);

/// Covariance of the values about rest, M squared, by the motion's correlation; without one every value goes
/// alone.
Eigen::MatrixXd rest_covariance(const FaceMotion& motion);

/// A prior for few active values that leaves the active ones alone.
class RestPull {
public:
    explicit RestPull(const FaceMotion& motion);

    /// About the values, to be added for the M of them: pull and information. likely: the best guess at them;
    /// seen: how visible each is, which decides the active ones; std: of each value.
    struct Terms {
        Eigen::VectorXd pull;
        Eigen::VectorXd information;
    };
    Terms at(const Eigen::VectorXd& values, const Eigen::VectorXd& likely, const Eigen::VectorXd& seen,
             const Eigen::VectorXd& std, double dead_zone) const;

    /// Visible part of each value: what remains after its antagonists.
    Eigen::VectorXd shown(const Eigen::VectorXd& values) const;

private:
    const FaceMotion* motion_;
    Eigen::MatrixXd undone_;  // M squared: of value i by one of antagonist j
    Eigen::MatrixXd frees_;   // M squared, 0 to 1: how much value i is known to be active by value j
};

}  // namespace mimetic
