// SPDX-License-Identifier: GPL-3.0-or-later
#include "depth_error.hpp"

namespace mimetic {

DepthErrors::DepthErrors(const FaceMotion& motion, const Eigen::Isometry3d& camera_from_head)
    : reference_(camera_from_head.linear()), sight_(camera_from_head.translation().normalized()) {
    for (Eigen::Index value = 0; value < motion.depth_std.size(); ++value) {
        if (const double std = motion.depth_std[value]; std > 0) {
            depths_.push_back({value, motion.prior_std[value], 1 / (std * std), 0});
        }
    }
}

/// By how much a point that lies a metre behind where it is taken to be seems moved along the head's x axis,
/// metres.
double DepthErrors::tangent(const Eigen::Isometry3d& camera_from_head) const {
    constexpr double kNarrowest = .3;  // beyond, that axis points at the camera
    const Eigen::Vector3d sight = camera_from_head.translation().normalized();
    const Eigen::Vector3d behind = camera_from_head.linear() * (reference_.transpose() * sight_);
    const Eigen::Vector3d axis = camera_from_head.linear().col(0);
    const Eigen::Vector3d seen = axis - sight * sight.dot(axis);
    return behind.dot(seen) / std::max(seen.squaredNorm(), kNarrowest * kNarrowest);
}

std::vector<ReadingError> DepthErrors::at(const Eigen::Isometry3d& camera_from_head) const {
    std::vector<ReadingError> errors;
    errors.reserve(depths_.size());
    const double turn = depths_.empty() ? 0 : tangent(camera_from_head);
    for (const Depth& depth : depths_) {
        errors.push_back({depth.value, turn * depth.mean(), turn * turn / depth.information});
    }
    return errors;
}

void DepthErrors::learn(const Eigen::Isometry3d& camera_from_head, Eigen::Index value, double reading,
                        double variance, double num_frames) {
    const double turn = tangent(camera_from_head);
    for (Depth& depth : depths_) {
        if (depth.value != value) {
            continue;
        }
        // The value itself is at rest most of the time and far from it now and then: a heavy tail
        constexpr double kTail = 2;
        const double spread = std::sqrt(depth.value_std * depth.value_std + variance);
        const double distance = std::abs(reading - turn * depth.mean()) / spread;
        const double weight = std::min(1., kTail / distance) / (spread * spread * std::max(1., num_frames));
        depth.information += weight * turn * turn;
        depth.pull += weight * turn * reading;
    }
}

}  // namespace mimetic
