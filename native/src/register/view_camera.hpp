// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/register/face_views.hpp>

namespace mimetic {

inline constexpr double kDistance = 4;  ///< of the camera, heights of its picture: faces are nearly parallel
inline constexpr double kFaceHeight = .30;  ///< m, what a picture of a head of the template's size shows
inline constexpr int kViewSize = 320;       ///< pixels of a side
inline const Eigen::Vector3d kFaceMiddle(0, -.01, .05);  ///< m, its middle, in the head frame

/// A head drawn from one direction, and the way back from its pixels.
struct ShadedView {
    Eigen::Matrix3d turn;
    Eigen::Vector3d middle;
    double distance;
    Camera camera;
    ShadedMesh head;  ///< in the view's frame: y up, z towards the viewer
    ShadedPicture shaded;

    /// target: the middle of the picture, in the head's frame; height: that the picture shows, in its unit.
    ShadedView(const ShownHead& shown, const Eigen::Matrix3d& view_from_head, const Eigen::Vector3d& target,
               double height, int size, const Eigen::Vector3d& light);

    Eigen::Vector3d point(const Eigen::Vector2d& pixel) const;  ///< head's frame; not finite beside the mesh
    Eigen::Vector2d pixel(const Eigen::Vector3d& point) const;  ///< of a point in the head's frame
};

/// The crop round 468 points, as the network was trained on.
FeatureCrop crop_round_points(const Points2& places);

/// The face in a picture, looked at again in the crop round what was seen.
FaceView settled_view(const ShadedView& view, const FeatureNetworks& networks, FeatureCrop crop);

}  // namespace mimetic
