// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "reference_view.hpp"
#include "tracked_face.hpp"

namespace mimetic {

/// The reference textures: the first, and those taken later, where it would show too little.
class ReferenceViews {
public:
    ReferenceViews(const TrackedFace& face, const FaceState& state, const cv::Mat1b& gray);

    ReferenceView& first() { return *views_.front(); }
    const ReferenceView& first() const { return *views_.front(); }

    /// Those to register a frame with, by the head's pose: the first, and one that is much nearer.
    std::vector<ReferenceView*> near(const Eigen::Isometry3d& camera_from_head) const;

    /// Pixels of a frame in one of the first texture, of a face that is there.
    double pixels_per_crop_pixel(const Eigen::Isometry3d& camera_from_head) const;

    /// Takes a texture where none is near; of a frame that is surely the face's. detail: its coefficients.
    void offer(const TrackedFace& face, const FaceState& state, const cv::Mat1b& gray, bool is_sure,
               const Eigen::VectorXd& detail);

private:
    std::vector<std::unique_ptr<ReferenceView>> views_;
    int frames_since_last_ = 0;
};

/// Angle between the directions from which two poses show the head, rad.
double view_angle(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second);

}  // namespace mimetic
