// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "joint_solver.hpp"
#include "motion_prior.hpp"

namespace mimetic {

/// What stays constant while a face is tracked.
struct TrackedFace {
    TrackedFace(const Camera& camera_in, const TrackedSurface& surface_in, const FaceMotion& motion_in,
                const TrackerOptions& options_in);
    TrackedFace(const TrackedFace&) = delete;
    TrackedFace& operator=(const TrackedFace&) = delete;

    Eigen::Index num_values() const { return motion.lower.size(); }
    Eigen::Index num_unknowns() const { return FaceStep::kPose + num_values(); }

    Camera camera;
    FaceMotion motion;
    RestPull to_rest;
    FaceSurface surface;
    TrackerOptions options;
    NoiseModel noise;
    Eigen::MatrixXd rest;       ///< M squared: covariance of the values about rest
    Eigen::MatrixXd rest_pull;  ///< M squared: its information in one frame
};

/// Throws InvalidInput unless a face can be tracked with these.
void check_inputs(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                  const FeatureInputs& features);

}  // namespace mimetic
