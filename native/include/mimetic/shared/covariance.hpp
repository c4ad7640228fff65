// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <limits>

namespace mimetic {

/// The symmetric, positive definite matrix nearest to a covariance with rounding errors. Compared as
/// correlations: radians and metres differ by orders of magnitude. least: of the correlations' eigenvalues.
Eigen::MatrixXd nearest_covariance(const Eigen::MatrixXd& covariance, double least = 1e-9);

/// Whether a matrix is a covariance up to rounding: finite, mirrored entries at most `asymmetry` apart, and
/// no correlation's eigenvalue below -1e-6.
bool is_covariance(const Eigen::MatrixXd& covariance,
                   double asymmetry = std::numeric_limits<double>::infinity());

}  // namespace mimetic
