// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/fit/fit.hpp>
#include <mimetic/shared/image.hpp>

namespace mimetic {

/// Points of a fitted face to track from one picture to another.
struct FollowedPoints {
    std::vector<int> points;  ///< K, of the model
    Points places;            ///< K x 3, metres, head frame
    Points normals;           ///< K x 3, unit, outwards
};

/// How far points of the face moved from the reference frame to a view's. Flow starts from the motion
/// that both poses predict; points that turn away, leave a picture, or fail the forward-backward check are
/// left out; none with fewer than twelve. pupil_distance_px: between the pupils in the view. Throws
/// InvalidInput where sizes do not agree.
std::vector<PointMotion> follow_points(const ColorView& reference, const ColorView& view,
                                       const Camera& camera, const Eigen::Isometry3d& reference_pose,
                                       const Eigen::Isometry3d& view_pose, const FollowedPoints& followed,
                                       double pupil_distance_px);

}  // namespace mimetic
