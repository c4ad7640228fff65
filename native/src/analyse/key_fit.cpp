// SPDX-License-Identifier: GPL-3.0-or-later
#include "key_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mimetic {
namespace {

// Weight of what is drawn between neighbouring frames, beside theirs: few of them leave slopes free
constexpr double kBetweenFew = .3, kBetweenMany = .1;
constexpr int kFew = 4;  // steps from a key to the next

/// Shares of two keys' values and slopes in a cubic at s, 0 to 1, of a span of so many frames.
Eigen::Vector4d hermite(double s, double span) {
    const double t = s * s, u = t * s;
    return {2 * u - 3 * t + 1, (u - 2 * t + s) * span, -2 * u + 3 * t, (u - t) * span};
}

/// The row before which no key of `keys` lies later, as an index of the span.
Eigen::Index span_of(const Eigen::VectorXd& keys, double frame) {
    const auto* begin = keys.data();
    const auto* end = begin + keys.size();
    const Eigen::Index after = std::upper_bound(begin, end, frame) - begin;
    return std::clamp<Eigen::Index>(after - 1, 0, keys.size() - 2);
}

/// Least squares of values and slopes at keys, each of which meets its neighbours alone.
struct KeyEquations {
    std::vector<Eigen::Matrix2d> own, next;  // next: of a key's row and the following key's column
    std::vector<Eigen::Vector2d> right;

    explicit KeyEquations(std::size_t count)
        : own(count, Eigen::Matrix2d::Zero()),
          next(count, Eigen::Matrix2d::Zero()),
          right(count, Eigen::Vector2d::Zero()) {}

    void add(std::size_t key, const Eigen::Vector4d& shares, double value) {
        const Eigen::Vector2d before = shares.head<2>(), after = shares.tail<2>();
        own[key] += before * before.transpose();
        own[key + 1] += after * after.transpose();
        next[key] += before * after.transpose();
        right[key] += value * before;
        right[key + 1] += value * after;
    }

    /// By elimination from the first key to the last; the equations are used up.
    std::vector<Eigen::Vector2d> solve() {
        for (std::size_t k = 1; k < own.size(); ++k) {
            const Eigen::Matrix2d share = next[k - 1].transpose() * own[k - 1].inverse();
            own[k] -= share * next[k - 1];
            right[k] -= share * right[k - 1];
        }
        std::vector<Eigen::Vector2d> solution(own.size());
        for (std::size_t k = own.size(); k-- > 0;) {
            if (k + 1 < own.size()) {
                right[k] -= next[k] * solution[k + 1];
            }
            solution[k] = own[k].inverse() * right[k];
        }
        return solution;
    }
};

/// What is played between frames keeps to straight lines from row to row, as far as the rows themselves
/// leave it free. Where none lies between two keys, none tells their slopes.
void hold_between(KeyEquations& equations, std::size_t key, VectorIn frames, VectorIn values, int first,
                  int last) {
    const double begin = frames[first], span = frames[last] - begin;
    const double weight = last - first <= kFew ? kBetweenFew : kBetweenMany;
    for (int row = first; row < last; ++row) {
        for (const double part : {.25, .5, .75}) {
            const double frame = (1 - part) * frames[row] + part * frames[row + 1];
            const double line = (1 - part) * values[row] + part * values[row + 1];
            Eigen::Vector4d shares = weight * hermite((frame - begin) / span, span);
            double value = weight * line;
            if (last == first + 1) {  // slopes alone: the keys' values are the rows'
                value -= shares[0] * values[first] + shares[2] * values[last];
                shares[0] = shares[2] = 0;
            }
            equations.add(key, shares, value);
        }
    }
}

}  // namespace

double SparseCurve::value(double frame) const {
    if (frames.size() == 1) {
        return values[0];
    }
    const Eigen::Index at = span_of(frames, frame);
    const double span = frames[at + 1] - frames[at];
    const double s = std::clamp((frame - frames[at]) / span, 0., 1.);
    return hermite(s, span).dot(Eigen::Vector4d(values[at], slopes[at], values[at + 1], slopes[at + 1]));
}

SparseCurve fit_keys(VectorIn frames, VectorIn values, const std::set<int>& rows, const CurveExtent& extent,
                     double tolerance) {
    const std::vector<int> keys(rows.begin(), rows.end());
    KeyEquations equations(keys.size());
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
        const double begin = frames[keys[k]], span = frames[keys[k + 1]] - begin;
        const int end = k + 2 == keys.size() ? keys[k + 1] : keys[k + 1] - 1;
        for (int row = keys[k]; row <= end; ++row) {
            equations.add(k, hermite((frames[row] - begin) / span, span), values[row]);
        }
        hold_between(equations, k, frames, values, keys[k], keys[k + 1]);
    }
    // Keys lie near the curve, and those at rest rest: a drag of another key must not lift them
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const double seen = values[keys[k]];
        const bool rests = extent.rests(seen, tolerance);
        const double hold = rests ? 1e6 : 1e-3;
        equations.own[k](0, 0) += hold;
        equations.right[k][0] += hold * (rests ? extent.low : seen);
        equations.own[k](1, 1) += rests ? 1e6 : 1e-6;
    }
    const std::vector<Eigen::Vector2d> solution = equations.solve();
    const auto count = static_cast<Eigen::Index>(keys.size());
    SparseCurve curve{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (Eigen::Index k = 0; k < count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        curve.frames[k] = frames[keys[at]];
        curve.values[k] = std::clamp(solution[at][0], extent.low, extent.high);
        curve.slopes[k] = solution[at][1];
    }
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        curve.error = std::max(curve.error, std::abs(curve.value(frames[i]) - values[i]));
    }
    return curve;
}

int farthest_row(const SparseCurve& curve, VectorIn frames, VectorIn values, const std::set<int>& rows) {
    int worst = -1;
    double most = -1;
    for (int i = 0; i < static_cast<int>(values.size()); ++i) {
        if (const double off = std::abs(curve.value(frames[i]) - values[i]);
            off > most && !rows.contains(i)) {
            most = off;
            worst = i;
        }
    }
    return worst;
}

}  // namespace mimetic
