// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

namespace mimetic {

/// Value of a picture between its pixels, for 0 <= x < cols - 1 and 0 <= y < rows - 1.
template <typename Scalar, typename Pixel>
Scalar bilinear(const cv::Mat_<Pixel>& image, Scalar x, Scalar y) {
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const Scalar a = x - static_cast<Scalar>(left), b = y - static_cast<Scalar>(top);
    const Pixel *up = image[top] + left, *down = image[top + 1] + left;
    const auto between = [a](const Pixel* row) {
        return (1 - a) * static_cast<Scalar>(row[0]) + a * static_cast<Scalar>(row[1]);
    };
    return (1 - b) * between(up) + b * between(down);
}

}  // namespace mimetic
