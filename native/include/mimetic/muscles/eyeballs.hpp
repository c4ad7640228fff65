// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <mimetic/muscles/articulators.hpp>

namespace mimetic {

/// Degrees in the head frame, 0 straight ahead: yaw positive to the subject's left, pitch positive up.
struct EyeAngles {
    double yaw = 0;
    double pitch = 0;
};

/// Unit vector in the head frame (x to the subject's left, y up, z out of the face).
Eigen::Vector3d gaze_direction(const EyeAngles& angles);

/// The inverse, of any vector that is not 0.
EyeAngles gaze_angles(const Eigen::Vector3d& direction);

/// The eyeball's rotation from straight ahead: without torsion about the line of sight (Listing's law).
Eigen::Matrix3d eye_rotation(const EyeAngles& angles);

/// Vertices (V x 3) with the eyeballs turned rigidly. eye_of: V, 0 none, 1 the left eye, 2 the right one;
/// centres: 2 x 3, metres; turns: of the left and the right eye. Throws InvalidInput.
Points turned_eyeballs(PointsIn vertices, const Eigen::VectorXi& eye_of, PointsIn centres,
                       const std::array<EyeAngles, 2>& turns);

/// The iris of an eyeball: its middle on the ball, then `count` points of its rim. iris_centre: of the ball
/// as it stands at rest; radius: of the iris, metres. Throws InvalidInput.
Points iris_circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& iris_centre, const EyeAngles& turn,
                   double radius, int count);

/// A rigid turn is linear in five numbers: displacements (5 x 3K) of an eyeball's points (K x 3), which
/// weighted by `eye_turn_weights` give `eye_rotation` without loss, as linear shapes must.
MatrixRows eye_turn_modes(PointsIn points, const Eigen::RowVector3d& centre);

/// Weights of the five modes, N x 5, for N turns.
MatrixRows eye_turn_weights(const Eigen::VectorXd& yaw, const Eigen::VectorXd& pitch);

/// Where eyes look on an upright plane so far in front of them, against straight ahead: N x 2, to the
/// subject's left and up, in the distance's unit, of N turns in degrees. Throws InvalidInput where sizes
/// differ, or an eye turns by more than kFarthestTurn.
inline constexpr double kFarthestTurn = 75;
Eigen::MatrixX2d gaze_offsets(const Eigen::VectorXd& yaw, const Eigen::VectorXd& pitch, double distance);

/// Of the eye's turn up and down, at the middle of the upper lid: it goes nearly as far as the eye (Becker
/// and Fuchs 1988, J. Neurophysiology 60); the share is assumed.
inline constexpr double kUpperFollows = 0.8;

/// Upper lids go along as the eyes turn up and down, and shut lids stay shut wherever the eye looks.
struct LidFollowing {
    double per_degree = 0;  ///< share of the opening that the lid is lowered by for each degree downwards
    double rest_pitch = 0;  ///< degrees: the gaze at which it is not carried
    static constexpr double kHighestCarried = .7;  ///< of the opening: lids do not shut by looking down
    static constexpr double kLowestCarried = -.6;

    /// Closure that is seen (N, 0 open to 1 shut) of the lid's own at gazes (N, degrees), and the inverse.
    /// Throw InvalidInput where sizes differ.
    Eigen::VectorXd seen(const Eigen::VectorXd& own, const Eigen::VectorXd& pitch) const;
    Eigen::VectorXd own(const Eigen::VectorXd& seen, const Eigen::VectorXd& pitch) const;
};

/// How far the upper lid of an eye is carried: nearly as far as the eye turns, a share of its opening.
double lid_following(const EyeLids& lids);

}  // namespace mimetic
