// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

namespace mimetic::locate {

/// A picture (RGB, 8 bits) as it would be in white light and clear air, judged by a part of it that shows a
/// face, or by all of it: where nearly all the light is of one colour, its channel in all three; where fog,
/// glare or a flat profile has left little contrast, that contrast on black as deep as is usual. The picture
/// itself, not a copy, where neither is so or the part is empty.
cv::Mat clear_view(const cv::Mat& color, const cv::Rect& part);

}  // namespace mimetic::locate
