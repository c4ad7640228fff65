// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lid_meter.hpp"
#include "tracked_face.hpp"

namespace mimetic {

/// The lids of both eyes, which flow cannot follow.
class LidReader {
public:
    /// gray: the reference frame, in which the face is so.
    LidReader(const TrackedFace& face, const std::vector<EyeSlit>& eyes, const cv::Mat1b& gray,
              const FaceState& state);

    /// The estimate with what each lid that is seen says in place of what flow said; before: the last state.
    FrameEstimate read(FrameEstimate estimate, const cv::Mat1b& gray, const FaceState& before) const;

private:
    FloatPixels project_control(const FaceState& state) const;

    const TrackedFace& face_;
    std::vector<LidMeter> lids_;
};

}  // namespace mimetic
