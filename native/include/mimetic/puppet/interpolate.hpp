// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// What falls or rises with the distance of two vectors of scores.
enum class Basis {
    linear,    ///< r: between examples on a line the state is piecewise linear [Poggio and Girosi 1990]
    gaussian,  ///< exp(-r^2 / 2 width^2)
};

struct InterpolationOptions {
    Basis basis = Basis::linear;
    double regularisation = 0;  ///< 0: chosen by cross-validation; to 1e3. Examples are met exactly near 0
    void check() const;         ///< throws InvalidInput: field, value, limit
};

/// Radial basis functions [Darrell, Essa and Pentland 1996]: scores of n templates to m values of a state,
/// by K examples. C = A G (G G + mu I)^-1 with G of the examples' distances; a(s) = sum c_k g(|s - s_k|),
/// with scores counted by their spread among the examples and states from the examples' mean.
class Interpolation {
public:
    /// scores: K x n; states: K x m; lower, upper: m. K from 1 to 1000, in order of time. Throws
    /// InvalidInput.
    Interpolation(MatrixIn scores, MatrixIn states, VectorIn lower, VectorIn upper,
                  const InterpolationOptions& options = {});

    Eigen::VectorXd state(VectorIn scores) const;  ///< m, within the limits

    /// m: what cross-validation misses by, the more the further the scores are from every example.
    Eigen::VectorXd std(VectorIn scores) const;

    double regularisation() const { return regularisation_; }
    double width() const { return width_; }

private:
    Eigen::VectorXd distances(VectorIn scores) const;

    Basis basis_;
    double regularisation_ = 0;
    double width_ = 1;
    double usual_distance_ = 0;  // of scores that were left out from the nearest example
    MatrixRows scores_;          // K x n, by their spreads
    Eigen::VectorXd per_score_;  // n
    Eigen::MatrixXd weights_;    // K x m
    Eigen::VectorXd lower_, upper_, mean_, error_;
};

/// Weights (J, from 0 on, their sum 1) of the corners (J x m) for the nearest state in their convex hull.
Eigen::VectorXd hull_weights(MatrixIn corners, VectorIn state);

}  // namespace mimetic
