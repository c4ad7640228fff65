// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <opencv2/core.hpp>

namespace mimetic {

bool says_no_memory(const std::exception& error) {
    const auto* const of_opencv = dynamic_cast<const cv::Exception*>(&error);
    return of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem;
}

}  // namespace mimetic
