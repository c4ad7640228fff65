// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/puppet/match.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

struct FrontViewOptions {
    double pixel = 1e-3;  ///< metres, of the picture's pixels on the face, 2e-4 to .01
    double left = -.08;   ///< metres in the head frame, of the picture's sides
    double right = .08;
    double bottom = -.1;
    double top = .09;
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// A face as from straight in front, however the head is turned: each pixel shows a place of the neutral
/// skin. Light and shade are the picture's.
class FrontView {
public:
    /// vertices: V x 3, metres, head frame; faces: F x 4 of the skin that is seen. Throws InvalidInput.
    FrontView(const Camera& camera, PointsIn vertices, QuadsIn faces, const FrontViewOptions& options = {});

    GrayPicture picture(const ColorView& image, const Eigen::Isometry3d& camera_from_head) const;

    /// Pixel of the picture that shows x, y of the head frame, metres.
    Eigen::Vector2d pixel_of(double x, double y) const;

private:
    Camera camera_;
    FrontViewOptions options_;
    int rows_ = 0, cols_ = 0;
    Points places_;  // rows * cols, metres, head frame
};

/// A grey picture of an image, `scale` times as large; .02 to 8.
GrayPicture scaled_gray(const ColorView& image, double scale);

}  // namespace mimetic
