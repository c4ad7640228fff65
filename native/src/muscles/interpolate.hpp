// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace mimetic {

/// The value at `x` on straight lines between (xs, ys), xs rising; beyond them, that at the end.
inline double interpolate(double x, const Eigen::VectorXd& xs, const Eigen::VectorXd& ys) {
    const Eigen::Index last = xs.size() - 1;
    if (!(x > xs[0])) {
        return ys[0];
    }
    if (x >= xs[last]) {
        return ys[last];
    }
    const Eigen::Index i = std::upper_bound(xs.data(), xs.data() + xs.size(), x) - xs.data() - 1;
    return (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]) * (x - xs[i]) + ys[i];
}

}  // namespace mimetic
