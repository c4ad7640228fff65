// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// What smoothing does to a curve, and how the remaining errors are correlated over time.
///
/// A capture's smoother weighs each frame's measurement against small second differences, so that a smoothed
/// curve is H z of measurements z with H = (I + ratio^2 D'D)^-1, D the second differences; independent noise
/// of the measurements then has the covariance H H' up to its scale. A performance stores no covariance
/// between frames: this is derived from the smoother's equations (docs/guide/timing.md).
class CurveNoise {
public:
    /// num_frames consecutive frames, 3 to 2000; ratio: s.d. of a measurement over that of a second
    /// difference, 0 to 1000. Throws InvalidInput.
    CurveNoise(int num_frames, double ratio);

    /// N x C: what the smoother makes of C true curves.
    Eigen::MatrixXd smoothed(const Eigen::Ref<const Eigen::MatrixXd>& curves) const;

    /// N x C: errors of smoothed curves with root mean square 1, of independent N x C standard normals.
    Eigen::MatrixXd correlated(const Eigen::Ref<const Eigen::MatrixXd>& normals) const;

    /// Effective number of independent values among N correlated ones, for estimating a variance.
    double effective_count() const { return effective_count_; }

private:
    // H's inverse is L D L' with two diagonals below that of L
    Eigen::VectorXd pivots_, below_, second_below_;
    double scale_ = 1;
    double effective_count_ = 0;
};

/// ratio of CurveNoise for a value with this standard deviation, at the smoother's usual options.
double smoothing_ratio(double value_std);

}  // namespace mimetic
