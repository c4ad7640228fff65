// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <opencv2/core.hpp>

namespace mimetic {

cv::Mat1b to_gray(const ColorView& image);

}  // namespace mimetic
