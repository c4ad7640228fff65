// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// An expression placed on a time line: values of C muscles and articulators in evenly spaced rows; 0 is
/// rest.
struct ExpressionPart {
    MatrixRows values;     ///< N x C, N at least 2
    MatrixRows stds;       ///< N x C, their standard deviations
    double start = 0;      ///< seconds, of the first row
    double length = 1;     ///< seconds from the first row to the last, above 0
    double strength = 1;   ///< that values are multiplied by, 0 to 10
    double dominance = 1;  ///< that its weight is multiplied by, 1e-6 to 1e6
};

/// How one expression gives way to another in a muscle that both move.
///
/// The dominance functions of [Cohen and Massaro 1993], one for each expression and muscle: alpha exp(-theta
/// |t|^c), where t is the time to the span in which the expression has the muscle near its highest. A
/// muscle's value is the mean of all expressions' values weighted by dominance. alpha is the square of that
/// highest value, and at no time a dominance is less than the square of the value then: an expression has no
/// say in muscles that it leaves alone, keeps what it holds, and plays unchanged alone.
struct CompositionOptions {
    double fading = 8;    ///< theta, 1 / second^c, 0 to 1000
    double exponent = 1;  ///< c, .1 to 4
    void check() const;   ///< throws InvalidInput: field, value, limit
};

struct Composition {
    MatrixRows values;  ///< T x C
    MatrixRows stds;    ///< T x C, parts taken as independent
};

/// The parts played together at so many seconds (T). Before its first row and after its last a part stays as
/// it is there. Throws InvalidInput: parts of different widths, times that are not finite.
Composition compose_expressions(const std::vector<ExpressionPart>& parts, VectorIn seconds,
                                const CompositionOptions& options = {});

/// A motion (N x C, N at least 2) less the straight line from its first row to its last: from rest to rest.
MatrixRows from_rest(MatrixIn values);

/// A still (C) as a motion of N rows: up along a smooth step over the first `rise` rows, down over the last
/// `fall`. rise, fall: above 0, together at most N - 1. Throws InvalidInput.
MatrixRows still_motion(VectorIn values, int num_rows, double rise, double fall);

}  // namespace mimetic
