// SPDX-License-Identifier: GPL-3.0-or-later
#include "gray.hpp"

#include <opencv2/imgproc.hpp>

#include "as_matrix.hpp"

namespace mimetic {

cv::Mat1b to_gray(const ColorView& image) {
    const cv::Mat color = as_matrix(image);
    cv::Mat1b gray;
    cv::cvtColor(color, gray, cv::COLOR_RGB2GRAY);
    return gray;
}

}  // namespace mimetic
