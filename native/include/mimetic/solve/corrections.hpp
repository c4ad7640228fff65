// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/solve.hpp>

namespace mimetic {

/// A point of the skin that a person put to a pixel.
struct SkinPin {
    Eigen::Vector3d neutral;  ///< metres, head frame, with what the values do not move (detail)
    MatrixRows modes;         ///< M x 3: of the point, metres at the value 1
    Eigen::Vector2d pixel;
    double std = 1;  ///< pixels
};

/// The head's pose as a person put it.
struct PosePin {
    Eigen::Isometry3d camera_from_head;
    double rotation_std = .01;      ///< rad
    double translation_std = 1e-3;  ///< metres
};

/// A weighted sum of the values: one of them, or the gap between two lips.
struct ValuePin {
    Eigen::VectorXd weights;  ///< M
    double target = 0;
    double std = .05;
};

/// What a person measured in one frame, each with its standard deviation.
struct Correction {
    int index = 0;     ///< of the estimate
    double reach = 8;  ///< frames before and after within which it counts
    std::vector<SkinPin> pins;
    std::vector<PosePin> poses;
    std::vector<ValuePin> values;
};

/// As `smooth`, with what a person measured beside what the pictures show.
///
/// In a corrected frame the corrections are Gaussian measurements. Where they contradict the pictures, these
/// are taken to be off there by a bias: a Gaussian process in time with the prior's covariance, whose
/// correlation over d frames is (1 - d / reach)^3 (1 + 3 d / reach) [Wendland 1995], none from `reach` on.
/// The pictures' evidence of all frames is moved by its expectation, then everything is solved together; so
/// neighbours follow a correction less and less, in the directions alone that it measured.
/// Estimates must be of successive frames. Their `gradient` is of the pictures alone, at the new state, and
/// so is the covariance of those that are not held. Throws InvalidInput: a correction of no frame, of another
/// face, not finite, without standard deviation.
std::vector<FrameEstimate> smooth_corrected(const std::vector<FrameEstimate>& estimates,
                                            const FaceMotion& motion, const Camera& camera,
                                            const std::vector<Correction>& corrections,
                                            const SmootherOptions& options = {},
                                            const Progress& progress = {});

/// Correlation of the pictures' bias in two frames.
double bias_correlation(double num_frames, double reach);

}  // namespace mimetic
