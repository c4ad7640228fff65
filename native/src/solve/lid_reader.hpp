// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lid_meter.hpp"
#include "tracked_face.hpp"

namespace mimetic {

/// The upper lids by their appearance, where no network measures them.
class LidReader {
public:
    /// gray: the reference frame, in which the face is so.
    LidReader(const TrackedFace& face, const std::vector<EyeSlit>& eyes, const cv::Mat1b& gray,
              const FaceState& state);

    void look(const cv::Mat1b& gray, const FaceState& near);
    void look_away();

    /// Information and right-hand side of the lids' measurement, at a state.
    StepPrior terms(const FaceState& state) const;

    /// The state with the lids as they were seen.
    FaceState with_lids(FaceState state) const;

private:
    FloatPixels project_control(const FaceState& state) const;

    const TrackedFace& face_;
    std::vector<LidMeter> lids_;
    std::vector<LidMeasurement> measured_;
};

}  // namespace mimetic
