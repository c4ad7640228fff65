// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

#include "depth_error.hpp"
#include "locate/recognition.hpp"
#include "tracked_face.hpp"

namespace mimetic {

/// State carried from frame to frame.
struct TrackMemory {
    cv::Mat1b gray;              ///< the last frame
    FaceState state;             ///< in the last frame that showed the face
    FaceStep velocity;           ///< a frame
    Eigen::MatrixXd covariance;  ///< of the state; it grows while the face is lost
    Eigen::VectorXd values_std;  ///< when the values were last measured
    bool is_lost = false;
    Recognition recognition;
    DepthErrors depth_errors;
};

/// Before anything was measured: the face is still, with the prior's covariance.
TrackMemory first_memory(const TrackedFace& face, cv::Mat1b gray, FaceState state);

/// The predicted state of a frame, before it is measured.
struct Expectation {
    FaceState mean;
    Eigen::MatrixXd covariance;   ///< (6 + M) squared, of a step from the mean
    Eigen::MatrixXd information;  ///< its inverse
    Eigen::VectorXd values_std;   ///< how well the values were known
    DepthErrors depth_errors;

    /// The same prediction about another state.
    Expectation about(const FaceState& state) const;

    /// As a prior of steps from a state, with the pull to rest there.
    StepPrior from(const FaceState& state, const TrackedFace& face) const;
};

Expectation predict(const TrackedFace& face, const TrackMemory& memory);

}  // namespace mimetic
