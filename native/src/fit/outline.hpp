// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/fit/fit.hpp>

namespace mimetic::fit {

/// A point between two of the model's points.
struct EdgePoint {
    int first = 0;
    int second = 0;
    double fraction = 0;  ///< 0 at first, 1 at second
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< image direction that leaves the face
};

/// The occluding contour: zero crossings of normal . ray on the mesh's edges.
std::vector<EdgePoint> outline(const FaceModel& model, const Points& points,
                               const Eigen::Isometry3d& camera_from_head, const Camera& camera);

/// The outermost of some points in order from the subject's left ear round the chin to the right ear:
/// one a sector, as seen from `center`.
Points2 jaw_line(const std::vector<EdgePoint>& points, const Eigen::Vector2d& center, double from_angle,
                 double to_angle, int count);

}  // namespace mimetic::fit
