// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/muscles/eyeballs.hpp>
#include <mimetic/solve/solve.hpp>
#include <vector>

namespace mimetic {

/// The eyeballs of a fitted head, the left first: head frame, metres.
struct Eyeballs {
    std::array<Eigen::Vector3d, 2> centres;
    std::array<double, 2> radii = {};            ///< from the centre to the front of the iris
    std::array<Eigen::Vector3d, 2> facing = {};  ///< of any length: which way the eyes' openings face
    void check() const;                          ///< throws InvalidInput
};

/// What is known of the eyes in one frame.
struct GazeFrame {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();  ///< metres
    Matrix6 pose_cov = Matrix6::Zero();                                  ///< (rotation vector, translation)
    std::array<SeenIris, 2> irises = {};                                 ///< the left first
};

/// One iris as a turn of its eyeball; degrees.
struct IrisTurn {
    bool is_seen = false;
    EyeAngles angles;
    Eigen::Matrix2d jitter = Eigen::Matrix2d::Zero();   ///< covariance, independent between frames
    Eigen::Matrix2d lasting = Eigen::Matrix2d::Zero();  ///< of errors that stay while pose and lids do
};

/// How far each eye usually is open, in diameters of its iris, the left first; 0: not known.
using UsualOpening = std::array<double, 2>;

/// The turn that puts the eye's iris where it was seen. Not seen: lids shut, the eye beyond the nose or the
/// face's outline. Lids that cover much of an iris, or more than they usually do, and a face that turns away
/// add to the covariance.
IrisTurn iris_turn(const Camera& camera, const Eyeballs& eyes, const GazeFrame& frame, int eye,
                   const UsualOpening& usual);

/// A clip's gaze; N x 4 degrees: yaw and pitch of the left, then of the right eye.
struct GazeTrack {
    MatrixRows angles;
    MatrixRows std;
    /// How the eyes stand on this head at gaze 0: the person's own (the angle kappa), the fit's and the
    /// network's error together, which no frame tells apart.
    std::array<EyeAngles, 2> rest = {};
    Eigen::Vector4d rest_std = Eigen::Vector4d::Zero();
};

/// Gaze is still or drifts, and jumps: saccades are followed within a frame, fixations are smoothed, by
/// increments of a heavy-tailed distribution (iteratively reweighted least squares). The eyes turn together,
/// but for vergence. Frames without an iris are bridged, and their standard deviations grow.
/// fps: frames a second; scene_starts: indices of frames after a cut, over which nothing is smoothed or
/// bridged. Throws InvalidInput.
GazeTrack follow_gaze(const Camera& camera, const Eyeballs& eyes, const std::vector<GazeFrame>& frames,
                      double fps, const std::vector<int>& scene_starts = {});

/// An angle of an eye as a person states it in a frame; degrees.
struct GazePin {
    int index = 0;  ///< of the frame
    int angle = 0;  ///< yaw, pitch of the left eye, then of the right one
    double value = 0;
    double std = 1;
    double reach = 8;  ///< frames before and after within which it counts
};

/// A clip's gaze (N x 4 degrees) with what a person states of some frames. What was followed is taken to be
/// off there by a bias of which next to nothing is known beforehand, but that both eyes have it alike, save
/// for vergence, and that it lasts: the process of `smooth_corrected`. Its expectation is added; saccades
/// stay as sharp as they are. Throws InvalidInput: a pin of no frame or angle, not finite, without standard
/// deviation.
MatrixRows corrected_gaze(const MatrixRows& angles, const std::vector<GazePin>& pins);

/// `follow_gaze` forward in time alone, for live use: each frame's gaze from it and those before. Rest is
/// learnt on the way, so that the first seconds lean on the prior.
class GazeFilter {
public:
    /// Throws InvalidInput.
    explicit GazeFilter(const Eyeballs& eyes);

    /// Degrees: yaw and pitch of the left, then of the right eye. seconds: since the frame before. Without an
    /// iris the eyes stay where they were.
    Eigen::Vector4d advance(const Camera& camera, const GazeFrame& frame, double seconds);

private:
    void learn_opening(const GazeFrame& frame);

    Eyeballs eyes_;
    Eigen::Vector4d state_, usual_;
    Eigen::Matrix4d covariance_;
    UsualOpening usual_opening_ = {};
    double num_seen_ = 0;
};

}  // namespace mimetic
