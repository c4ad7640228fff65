// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/curve_edits.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {

namespace {

constexpr double kReach = 4;  // standard deviations, beyond which a neighbour weighs less than 1/2000

struct Window {
    Eigen::Index first, count;
    double width;
};

/// What lies within reach of a frame, and at least its three nearest.
Window window_at(VectorIn frames, double frame, double width) {
    const double* begin = frames.data();
    const double* end = begin + frames.size();
    const double* low = std::lower_bound(begin, end, frame - kReach * width);
    const double* high = std::upper_bound(low, end, frame + kReach * width);
    while (high - low < 3 && (low > begin || high < end)) {
        const bool is_lower_nearer = high == end || (low > begin && frame - low[-1] <= *high - frame);
        is_lower_nearer ? --low : ++high;
    }
    const double farthest = std::max(std::abs(frame - *low), std::abs(high[-1] - frame));
    return {low - begin, high - low, high - low <= 3 ? std::max(width, farthest / kReach) : width};
}

constexpr Eigen::Index kInner = 4;  // places between two keys, to which slopes are fitted

/// Their shares of a span.
Eigen::ArrayXd inner_shares() {
    return (Eigen::ArrayXd::LinSpaced(kInner, 0, kInner - 1) + .5) / static_cast<double>(kInner);
}

/// K numbers of a symmetric system in which each meets its two neighbours alone; 0 where nothing tells one,
/// of a single key and of keys at one frame.
Eigen::VectorXd solved_by_neighbours(Eigen::VectorXd diagonal, const Eigen::VectorXd& beside,
                                     Eigen::VectorXd right) {
    const auto over = [](double value, double pivot) { return pivot > 0 ? value / pivot : 0; };
    for (Eigen::Index i = 0; i + 1 < diagonal.size(); ++i) {
        const double factor = over(beside[i], diagonal[i]);
        diagonal[i + 1] -= factor * beside[i];
        right[i + 1] -= factor * right[i];
    }
    for (Eigen::Index i = diagonal.size() - 1; i >= 0; --i) {
        const double after = i + 1 < diagonal.size() ? beside[i] * right[i + 1] : 0;
        right[i] = over(right[i] - after, diagonal[i]);
    }
    return right;
}

}  // namespace

SmoothedCurve smooth_curve(VectorIn frames, VectorIn values, VectorIn at, double width) {
    require(frames.size() > 0 && frames.size() == values.size(), "smooth_curve: a value for each frame");
    require(frames.allFinite() && values.allFinite() && at.allFinite(), "smooth_curve: numbers are finite");
    check_range("width of smoothing in frames", width, 0, 1e6);
    for (Eigen::Index i = 1; i < frames.size(); ++i) {
        require(frames[i] > frames[i - 1], "smooth_curve: frames must rise");
    }
    SmoothedCurve curve{Eigen::VectorXd(at.size()), Eigen::VectorXd::Zero(at.size())};
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        const Window window = window_at(frames, at[i], width);
        if (window.count == 1 || window.width <= 0) {
            curve.values[i] = values[window.first];
            continue;
        }
        // Of the parabola through time in units of the width: value, slope, curvature
        const Eigen::ArrayXd times =
            (frames.segment(window.first, window.count).array() - at[i]) / window.width;
        const Eigen::ArrayXd weights = (-.5 * times.square()).exp();
        const Eigen::Index degree = std::min<Eigen::Index>(window.count - 1, 2);
        Eigen::MatrixXd terms(window.count, degree + 1);
        terms.col(0).setOnes();
        for (Eigen::Index power = 1; power <= degree; ++power) {
            terms.col(power) = terms.col(power - 1).array() * times;
        }
        const Eigen::MatrixXd weighted = weights.matrix().asDiagonal() * terms;
        const Eigen::VectorXd parabola =
            (weighted.transpose() * terms)
                .fullPivLu()
                .solve(weighted.transpose() * values.segment(window.first, window.count));
        curve.values[i] = parabola[0];
        curve.slopes[i] = parabola[1] / window.width;
    }
    return curve;
}

SmoothedCurve smooth_keys(VectorIn frames, VectorIn values, VectorIn keys, double width) {
    SmoothedCurve curve = smooth_curve(frames, values, keys, width);
    const Eigen::Index num_spans = std::max<Eigen::Index>(keys.size() - 1, 0);
    const Eigen::ArrayXd share = inner_shares();
    const Eigen::ArrayXd rise = share.square() * (3 - 2 * share);
    // What a slope at either end adds to the cubic, in spans
    const Eigen::VectorXd leaving = share * (1 - share).square(), arriving = share.square() * (share - 1);
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(keys.size()), right = diagonal, beside(num_spans);
    for (Eigen::Index i = 0; i < num_spans; ++i) {
        const double span = keys[i + 1] - keys[i], cubed = std::pow(span, 3);
        const Eigen::VectorXd at = keys[i] + span * share;
        const Eigen::VectorXd rest = smooth_curve(frames, values, at, width).values.array() -
                                     (curve.values[i] + (curve.values[i + 1] - curve.values[i]) * rise);
        diagonal[i] += cubed * leaving.squaredNorm();
        diagonal[i + 1] += cubed * arriving.squaredNorm();
        beside[i] = cubed * leaving.dot(arriving);
        right[i] += span * span * rest.dot(leaving);
        right[i + 1] += span * span * rest.dot(arriving);
    }
    curve.slopes = solved_by_neighbours(std::move(diagonal), beside, std::move(right));
    return curve;
}

Eigen::VectorXd retimed_frames(VectorIn frames, double first, double last, double factor) {
    check_range("factor of a curve's time", factor, 1e-3, 1e3);
    require(first <= last, "retimed_frames: the last frame is before the first");
    const Eigen::ArrayXd inside = frames.array().max(first).min(last);
    return frames.array() + (factor - 1) * (inside - first);
}

}  // namespace mimetic
