// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cover.hpp"
#include "detail_solver.hpp"
#include "face_registrar.hpp"
#include "feature_evidence.hpp"
#include "flow_follower.hpp"
#include "lost_face_search.hpp"

namespace mimetic {

/// A frame passes through these in turn; `memory` alone goes on to the next, with new textures.
struct FaceTracker::State {
    State(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
          const FeatureInputs& inputs, const TrackerOptions& options, const ColorView& image,
          const cv::Mat1b& gray, const Eigen::Isometry3d& camera_from_head);

    void check_frame(const ColorView& image) const;  ///< throws InvalidInput
    FrameEstimate follow(FrameAtHand& frame, const std::optional<Eigen::Isometry3d>& guess);

    FaceState start_of(const Expectation& expected, FrameAtHand& frame);
    Registration search_again(const Expectation& expected, const Registration& near, FrameAtHand& frame,
                              const std::optional<Eigen::Isometry3d>& guess, const Recognition& recognition);
    FrameEstimate measured_estimate(const Expectation& expected, const Registration& found);
    FrameEstimate held_estimate(const Expectation& expected, const FrameScore& score) const;
    void look_for_cover(const FaceState& state, FrameAtHand& frame);

    struct Hidden {
        // Of what is measured and turned to the camera:
        double came = 0;           ///< share before which something came
        double at_all = 0;         ///< share before which something came or stands still
        Eigen::ArrayXd of_values;  ///< M: share of the motion by each value that is hidden
    };
    Hidden hidden_by_cover(const FaceState& state, const ProjectedSurface& projected) const;
    void learn_depth(const Expectation& expected, const Registration& found, DepthErrors& depth_errors) const;

    TrackedFace face;
    Cover cover;
    FeatureEvidence features;
    TrackMemory memory;
    ReferenceViews views;
    FlowFollower follower;
    FaceRegistrar registrar;
    LostFaceSearch search;
    DetailSolver detail_solver;
    Measured last_measured;  // the measurements behind the last estimate
};

}  // namespace mimetic
