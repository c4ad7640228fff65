// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference_views.hpp"

#include <mimetic/shared/error.hpp>

namespace mimetic {

namespace {

constexpr double kWorthIt = .1;        // rad by which another texture must be nearer than the first
constexpr double kKeyViewAngle = .26;  // rad from the nearest texture
constexpr int kKeyViewFrames = 10;     // between two textures

std::unique_ptr<ReferenceView> take_view(const TrackedFace& face, const FaceState& state,
                                         const cv::Mat1b& gray) {
    return std::make_unique<ReferenceView>(face.surface, face.camera, state, gray, face.options.crop_height,
                                           face.options.sample_spacing,
                                           flow_blur_px(face.options.flow_method));
}

}  // namespace

double view_angle(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second) {
    const auto towards_camera = [](const Eigen::Isometry3d& pose) -> Eigen::Vector3d {
        return -(pose.linear().transpose() * pose.translation()).normalized();
    };
    return std::acos(std::clamp(towards_camera(first).dot(towards_camera(second)), -1., 1.));
}

ReferenceViews::ReferenceViews(const TrackedFace& face, const FaceState& state, const cv::Mat1b& gray) {
    views_.push_back(take_view(face, state, gray));
}

std::vector<ReferenceView*> ReferenceViews::near(const Eigen::Isometry3d& camera_from_head) const {
    const auto angle = [&](std::size_t k) {
        return view_angle(views_[k]->camera_from_head(), camera_from_head);
    };
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < views_.size(); ++k) {
        if (angle(k) < angle(nearest)) {
            nearest = k;
        }
    }
    if (nearest == 0 || angle(0) - angle(nearest) < kWorthIt) {
        return {views_.front().get()};
    }
    return {views_.front().get(), views_[nearest].get()};
}

double ReferenceViews::pixels_per_crop_pixel(const Eigen::Isometry3d& camera_from_head) const {
    const double nearer = first().camera_from_head().translation().z() / camera_from_head.translation().z();
    return nearer / first().scale();
}

void ReferenceViews::offer(const TrackedFace& face, const FaceState& state, const cv::Mat1b& gray,
                           bool is_sure, const Eigen::VectorXd& detail) {
    ++frames_since_last_;
    if (!is_sure || static_cast<int>(views_.size()) > face.options.max_key_views ||
        frames_since_last_ < kKeyViewFrames) {
        return;
    }
    for (const auto& view : views_) {
        if (view_angle(view->camera_from_head(), state.camera_from_head) < kKeyViewAngle) {
            return;
        }
    }
    try {
        views_.push_back(take_view(face, state, gray));
        frames_since_last_ = 0;
        // Of detail, about half is motion; the rest is shape, which differs with the view.
        constexpr double kMoved = .5;
        views_.back()->keep_detail(kMoved * detail);
    } catch (const InvalidInput&) {
        return;  // too little of the face is visible for a texture
    }
}

}  // namespace mimetic
