// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/head.hpp>
#include <vector>

namespace mimetic {

/// How much of each kind, in standard deviations.
using Expression = Eigen::Vector<double, kNumExpressions>;

/// Inverse variance of each kind at an angle (rad) from the first texture. Most expressions are none and a
/// few are strong, so that `now`, what it is taken for so far, widens it (Cauchy). Where a simple model is
/// turned far, what it is off by would be taken for an expression.
double expression_precision(double angle, const Expression& now);

/// Displacements of skin by each kind of movement, on a grid over the face as seen from the front.
class ExpressionField {
public:
    using Movements = Eigen::Matrix<double, 3, kNumExpressions>;  ///< metres, head frame

    ExpressionField(PointsIn vertices, MatrixIn movements);

    /// Null behind and beside the face.
    const Movements* at(const Eigen::Vector3d& point_in_head) const;

private:
    int cols_ = 0, rows_ = 0;
    Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
    std::vector<Movements> cells_;
};

}  // namespace mimetic
