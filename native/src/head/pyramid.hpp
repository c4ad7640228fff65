// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "seen_head.hpp"

namespace mimetic::head {

constexpr int kLevels = 3;

/// A crop at one resolution.
struct PyramidLevel {
    Camera camera;
    cv::Mat1f gray;
};

/// The finest level, which has the crop's pixels, first; each has half of the one before.
using Pyramid = std::array<PyramidLevel, kLevels>;

Pyramid make_pyramid(const HeadCrop& crop);

/// A level less its mean, over its standard deviation, of a window round each pixel, so that it does not
/// depend on light or contrast. Only what is in the mask (1: head, 0: not) enters: the edge to the wall
/// behind does not turn with the head. 0 outside.
cv::Mat1f normalised(const cv::Mat1f& gray, const cv::Mat1f& mask, std::size_t level);

}  // namespace mimetic::head
