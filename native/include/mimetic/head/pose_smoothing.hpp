// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Rigid motion through time, one entry a frame.
struct PoseSequence {
    std::vector<Eigen::Isometry3d> poses;  ///< metres
    std::vector<Matrix6> covariances;      ///< of (rotation vector, translation): exp(d) R, t + d; rad, m
};

/// Smooths rigid motion forward and backward, so that there is no lag: the Kalman smoother of [Rauch,
/// Tung, Striebel 1965]. State: rotation vector from the clip's mean pose and translation, and their rates,
/// which take random accelerations. How much the head moves is estimated from the clip: the accelerations
/// under which its poses are most likely. seconds: N, rising; measured: N, false where a pose is held: it
/// does not count, and after half a second of such frames another motion begins; strength: what the standard
/// deviations are multiplied by, 0 leaves the motion alone. Throws InvalidInput for a strength below 0, for
/// lengths that differ, for times that do not rise and where rounding leaves nothing to solve.
PoseSequence smooth_poses(const PoseSequence& motion, VectorIn seconds, const std::vector<bool>& measured,
                          double strength);

}  // namespace mimetic
