// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/puppet/texels.hpp>
#include <mimetic/shared/checks.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic {

Texels texels_of(const ColorView& image, int most_cols) {
    check_image_size(image.rows, image.cols, "the picture");
    check_range("most_cols", most_cols, 16, 4096);
    const cv::Mat whole = as_matrix(image);
    cv::Mat shown = whole;
    if (image.cols > most_cols) {
        const int rows = std::max(1, cvRound(double(image.rows) * most_cols / image.cols));
        cv::resize(whole, shown, {most_cols, rows}, 0, 0, cv::INTER_AREA);
    }
    cv::Mat upward, opaque;
    cv::flip(shown, upward, 0);
    cv::cvtColor(upward, opaque, cv::COLOR_RGB2RGBA);
    cv::Mat4f numbers;
    opaque.convertTo(numbers, CV_32F, 1. / 255);
    const float* first = numbers.ptr<float>();
    return {numbers.rows, numbers.cols, {first, first + 4 * numbers.total()}};
}

}  // namespace mimetic
