// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cover.hpp"
#include "reference_views.hpp"

namespace mimetic {

/// 0 to 1: how far the skin of a sample is turned to the camera, 0 where it is seen aslant or from behind.
/// eye: the camera's place, head frame.
float turned_to_camera(const ReferenceSample& sample, const Triangles& triangles,
                       const ProjectedSurface& projected, const Eigen::Vector3f& eye);

/// The camera's place, metres, head frame.
Eigen::Vector3f eye_in_head(const FaceState& state);

/// Visibility of the skin under a hypothesis.
class Sight {
public:
    Sight(const TrackedFace& face, const Cover& cover) : face_(face), cover_(cover) {}

    /// Rasterises the depth at low resolution. face_height: pixels.
    void draw(const ProjectedSurface& projected, const FaceState& state, double face_height);

    /// The same where the head has moved so far since that skin would lie behind what was drawn of itself;
    /// otherwise occlusion hardly changes with a step.
    void follow(const ProjectedSurface& projected, const FaceState& state, double face_height);

    /// Visibility of each sample of a view, 0 to 1.
    std::vector<float> visible(const ReferenceView& view, const ProjectedSurface& projected,
                               const FaceState& state) const;

private:
    const TrackedFace& face_;
    const Cover& cover_;  // of the present frame
    Raster raster_;
    RasterGrid grid_;
    Eigen::Isometry3d drawn_ = Eigen::Isometry3d::Identity();  // camera from head
};

}  // namespace mimetic
