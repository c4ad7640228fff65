// SPDX-License-Identifier: GPL-3.0-or-later
#include "gray.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic {

cv::Mat1b to_gray(const ColorView& image) {
    // OpenCV has no read-only matrix; nothing here writes to it.
    const cv::Mat color(image.rows, image.cols, CV_8UC3, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    cv::Mat1b gray;
    cv::cvtColor(color, gray, cv::COLOR_RGB2GRAY);
    return gray;
}

}  // namespace mimetic
