// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/head/head.hpp>
#include <opencv2/core.hpp>

namespace mimetic::head {

/// The point of a model that each pixel of a camera shows.
struct SeenHead {
    cv::Mat3f points;   ///< head frame, metres
    cv::Mat3f normals;  ///< head frame, outwards
    cv::Mat1f facing;   ///< cosine of normal and view; 0: no model here
};

SeenHead see_head(const HeadShape& shape, const Camera& camera, const Eigen::Isometry3d& camera_from_head);

/// Weight of a point, lowered by the non-rigid parts.
double rigidity(const HeadShape& shape, const Eigen::Vector3d& point_in_head);

/// A camera for every `spacing`th pixel of another, from pixel (spacing / 2, spacing / 2) on.
Camera thin_camera(const Camera& camera, int spacing);

/// The part of a frame around the head, made smaller if it has more pixels than needed.
struct HeadCrop {
    Camera camera;  ///< of the part
    cv::Mat1b gray;
    double scale = 1;  ///< its pixels in a pixel of the frame
};

/// Camera of the box around the head and of `margin` box sizes beyond; nothing if the head is out of view.
std::optional<Camera> crop_camera(const HeadShape& shape, const Camera& camera,
                                  const Eigen::Isometry3d& camera_from_head, int crop_height, double margin);

/// A frame of the camera; throws InvalidInput if it has another size.
cv::Mat1b gray_frame(const ColorView& image, const Camera& camera);

HeadCrop cut(const cv::Mat1b& frame, const Camera& camera, const Camera& part);

}  // namespace mimetic::head
