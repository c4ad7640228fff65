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

Eigen::VectorXd retimed_frames(VectorIn frames, double first, double last, double factor) {
    check_range("factor of a curve's time", factor, 1e-3, 1e3);
    require(first <= last, "retimed_frames: the last frame is before the first");
    const Eigen::ArrayXd inside = frames.array().max(first).min(last);
    return frames.array() + (factor - 1) * (inside - first);
}

}  // namespace mimetic
