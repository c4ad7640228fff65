// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// 1/2 w' hessian w - linear' w + sparsity' |w| over lowest <= w <= highest, K unknowns.
///
/// The elastic net with bounds: few values that are not 0, none beyond what a slider allows.
struct BoundedProblem {
    Eigen::MatrixXd hessian;   ///< K x K, symmetric, positive semidefinite
    Eigen::VectorXd linear;    ///< K
    Eigen::VectorXd sparsity;  ///< K, at least 0
    Eigen::VectorXd lowest;    ///< K, at most 0
    Eigen::VectorXd highest;   ///< K, at least 0
    void check() const;        ///< throws InvalidInput: sizes, numbers that are not finite, bounds

    double value(VectorIn at) const;
    /// How far the conditions of Karush, Kuhn and Tucker are missed, K: 0 at a minimum. In the units of
    /// linear.
    Eigen::VectorXd violation(VectorIn at) const;
};

/// The minimum, by coordinate descent (Friedman, Hastie and Tibshirani 2010) from `start` (K), and exactly on
/// the unknowns that end between their bounds. An unknown whose diagonal is 0 stays 0.
Eigen::VectorXd fit_bounded(const BoundedProblem& problem, VectorIn start);

}  // namespace mimetic
