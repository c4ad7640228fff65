// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/gaze.hpp>

namespace mimetic {

using GazeState = Eigen::Vector4d;  ///< degrees: both eyes' yaw and pitch, vergence (yaw R - L), pitch L - R

inline constexpr double kFixation = 30;  ///< frames

// Degrees a frame, at 30 frames a second; the eyeballs of the canonical head are 1.4 times as large as
// people's, so that they turn less for the same way of an iris.
inline constexpr double kDrift = .12;  ///< of fixations
inline constexpr double kVergenceDrift = .06;
inline constexpr double kTail = 2.5;  ///< in drifts: from here on an increment counts as a saccade

/// Standard deviations of a state of which nothing is seen.
inline const GazeState kUnseen(15, 15, 5, 5);

/// The state of eyes that look straight ahead into the distance of a room.
GazeState straight_ahead();

/// The eyes' four angles from the state.
Eigen::Matrix4d eyes_by_state();

/// Information (4 x 4) and right-hand side (4) of a frame's irises; robust, given the present state.
void add_irises(const std::array<IrisTurn, 2>& turns, const GazeState* present, Eigen::MatrixXd& information,
                Eigen::VectorXd& pull);

/// The state that is usually seen, and in how many frames eyes were seen at all.
struct UsualGaze {
    GazeState median = straight_ahead();
    double num_seen = 0;
};

/// What of it is the eyes' rest, by how far each may stray: state, then variances.
std::pair<GazeState, GazeState> rest_of(const UsualGaze& usual);

/// The eyes' four angles that a state means: networks see irises too near to where they usually are.
Eigen::Vector4d turned_eyes(const GazeState& state, const UsualGaze& usual);

/// The turn within what eyes can do.
EyeAngles within_eyes_range(const EyeAngles& turn);

/// The turn that takes an eye which rests at one direction to another, within what eyes can do.
EyeAngles turn_between(const EyeAngles& rest, const EyeAngles& seen);

}  // namespace mimetic
