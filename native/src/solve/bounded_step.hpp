// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

namespace mimetic {

/// argmin 1/2 d^T information d - gradient^T d with lower <= d <= upper (infinite bounds are free), by a
/// primal active set; information must be positive definite, and lower <= 0 <= upper.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                             const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace mimetic
