// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <opencv2/core.hpp>

namespace mimetic {

/// The view's pixels as OpenCV takes them, not copied: to be read alone, since OpenCV has no read-only
/// matrix. CV_8UC1 or CV_8UC3.
template <int Channels>
cv::Mat as_matrix(const ImageView<Channels>& image) {
    return {image.rows, image.cols, CV_8UC(Channels), const_cast<std::uint8_t*>(image.data),
            static_cast<std::size_t>(image.stride)};
}

}  // namespace mimetic
