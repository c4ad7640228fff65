// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/analyse/sparse_curve.hpp>
#include <set>

namespace mimetic {

/// Between which values a dense curve lies; it is at rest at the lower one.
struct CurveExtent {
    double low, high;
    explicit CurveExtent(VectorIn values) : low(values.minCoeff()), high(values.maxCoeff()) {}
    bool rests(double value, double tolerance) const { return value - low < .5 * tolerance; }
};

/// Values and slopes at the keys that come nearest to a dense curve, all at once, and how far it is off.
/// rows: those of `frames` and `values` (N) that have a key, the first and the last among them; extent: of
/// the curve of which these are a part.
SparseCurve fit_keys(VectorIn frames, VectorIn values, const std::set<int>& rows, const CurveExtent& extent,
                     double tolerance);

/// The row without a key at which the curve is farthest off, or -1.
int farthest_row(const SparseCurve& curve, VectorIn frames, VectorIn values, const std::set<int>& rows);

}  // namespace mimetic
