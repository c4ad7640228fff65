// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// A square of the picture, the input of a network, turned so that the head is upright in it.
struct FeatureCrop {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< pixels
    double side = 0;                                   ///< pixels
    double roll = 0;                                   ///< radians, clockwise in the picture

    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// The square round a point of the head. It follows from the pose alone, so that jitter of a network's output
/// does not feed back into its next input.
/// point_in_head, side: metres. Throws InvalidInput for a point that is not in front of the camera.
FeatureCrop crop_round(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                       const Eigen::Vector3d& point_in_head, double side);

/// The squares for the whole face and for both eyes, the left first.
struct FeatureCrops {
    FeatureCrop face;
    std::array<FeatureCrop, 2> eyes;
};

/// The crops of one frame, as large as MediaPipe's own, which the networks were trained on.
/// anchors: 6 x 3, metres, head frame: of one person's neutral surface the hairline, the menton, the outer
/// and the inner corner of the left eye, and those of the right eye. Throws InvalidInput.
FeatureCrops feature_crops(const Camera& camera, const Eigen::Isometry3d& camera_from_head, PointsIn anchors);

}  // namespace mimetic
