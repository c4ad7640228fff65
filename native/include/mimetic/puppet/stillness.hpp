// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/puppet/low_lag_filter.hpp>
#include <optional>

namespace mimetic {

/// What a live face does in one frame: pose and values, as `FrameEstimate` has them.
struct LivePose {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();  ///< metres
    Eigen::VectorXd values;
};

/// Takes the jitter out of a live face without a look ahead, by a `LowLagFilter` over pose and values. One
/// number, the stillness, chooses between lag and jitter: 0 is no filter at all.
class StillnessFilter {
public:
    /// stillness: 0 least lag to 1 least jitter. Throws InvalidInput.
    explicit StillnessFilter(double stillness);

    double stillness() const { return stillness_; }

    /// Takes effect with the next frame. Throws InvalidInput.
    void set_stillness(double stillness);

    /// The next frame; seconds: since the one before. Frames may be missing between them. The first one, one
    /// of another number of values, and one after a second or more are taken as they are. Throws
    /// InvalidInput.
    LivePose advance(const LivePose& measured, double seconds);

private:
    double stillness_;
    /// Of the rotation vector from facing the camera, translation, values
    std::optional<LowLagFilter> filter_;
};

/// What a stillness costs and gives at a rate.
struct StillnessFigures {
    double lag_frames = 0;    ///< of a muscle that goes from 0 to .5 in a third of a second, at half its way
    double jitter_share = 0;  ///< of a still face's jitter that remains, in standard deviations
};

/// By running the filter. fps: frames a second, above 0. Throws InvalidInput.
StillnessFigures stillness_figures(double stillness, double fps);

}  // namespace mimetic
