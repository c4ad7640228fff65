// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <mimetic/shared/image.hpp>

namespace mimetic {

/// Bilinear colour between the pixels of a picture, 0 to 255; held at the border.
inline Eigen::Vector3d colour_at(const ColorView& image, const Eigen::Vector2d& pixel) {
    const double x = std::clamp(pixel.x(), 0., image.cols - 1.);
    const double y = std::clamp(pixel.y(), 0., image.rows - 1.);
    const int left = std::min(static_cast<int>(x), image.cols - 2);
    const int top = std::min(static_cast<int>(y), image.rows - 2);
    const double u = x - left, v = y - top;
    Eigen::Vector3d colour;
    for (int channel = 0; channel < 3; ++channel) {
        const std::uint8_t* upper = image.row(top) + 3 * left + channel;
        const std::uint8_t* lower = image.row(top + 1) + 3 * left + channel;
        colour[channel] =
            (1 - v) * ((1 - u) * upper[0] + u * upper[3]) + v * ((1 - u) * lower[0] + u * lower[3]);
    }
    return colour;
}

}  // namespace mimetic
