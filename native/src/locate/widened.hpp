// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/locate.hpp>
#include <opencv2/core.hpp>

namespace mimetic::locate {

/// A picture whose edges go on outside of it: what is searched for faces wants a margin about them, which a
/// face that fills its picture does not leave. As much wider as a picture may be.
class Widened {
public:
    explicit Widened(ColorView image);

    ColorView view() const;
    /// A face found in the view, in pixels of the picture.
    FaceFeatures in_picture(FaceFeatures face) const;

private:
    int margin_;  // pixels on each side
    cv::Mat3b wide_;
};

}  // namespace mimetic::locate
