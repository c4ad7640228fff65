// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/video/tracking.hpp>

#include "cover.hpp"
#include "expectation.hpp"
#include "reference_view.hpp"

namespace mimetic {

/// The whole face's motion from frame to frame, wherever the textures would not reach.
class FlowFollower {
public:
    /// cover: of the last frame, while the flow since then is followed.
    FlowFollower(const TrackedFace& face, const Cover& cover, ErrorField<float> error_field);

    /// Where the flow since the last frame takes the face; what is expected if it shows too little of it.
    /// view: its samples are followed.
    FaceState follow(const Expectation& expected, const TrackMemory& memory, const cv::Mat1b& gray,
                     const ReferenceView& view);

private:
    /// The flow of the part of the picture with the face, made smaller.
    struct PartFlow {
        cv::Rect box;
        double scale = 1;
        cv::Mat2f flow;  // none: the part is too small
    };

    PartFlow flow_of_face(const cv::Mat1b& last, const cv::Mat1b& gray, const ReferenceView& view);
    std::vector<SampleMeasurement> measure(const PartFlow& part, const ReferenceView& view) const;

    const TrackedFace& face_;
    const Cover& cover_;
    JointSolver solver_;
    cv::Ptr<cv::DISOpticalFlow> flow_;
    ProjectedSurface projected_;  // as the last frame had the face
};

}  // namespace mimetic
