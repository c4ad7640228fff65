// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// A curve at M frames, and how fast it changes there.
struct SmoothedCurve {
    Eigen::VectorXd values;  ///< M
    Eigen::VectorXd slopes;  ///< M, a frame
};

/// A curve (N frames, rising; N values) without what changes faster than about `width` frames: at each of the
/// M frames `at`, the parabola nearest to the curve, neighbours weighed by a Gaussian of this standard
/// deviation [Cleveland 1979; Fan and Gijbels 1996]. It keeps straight lines and parabolas as they are, to
/// the ends, and does not depend on how densely a curve is sampled. Where `width` reaches fewer than three
/// frames the nearest three are taken, which keeps the values. width: from 0 on. Throws InvalidInput.
SmoothedCurve smooth_curve(VectorIn frames, VectorIn values, VectorIn at, double width);

/// The smoothed curve at K keys (frames, rising), with the slopes whose cubics between the keys lie nearest
/// to it, by least squares over time: the slope of one moment, beside a corner, would be stretched over a
/// third of a span, and the cubic would swing out. The rest as for `smooth_curve`.
SmoothedCurve smooth_keys(VectorIn frames, VectorIn values, VectorIn keys, double width);

/// Frames (N) in another time: what lies from `first` to `last` takes `factor` times as long, what comes
/// before stays, and what comes after is moved by as much. factor: above 0. Throws InvalidInput.
Eigen::VectorXd retimed_frames(VectorIn frames, double first, double last, double factor);

}  // namespace mimetic
