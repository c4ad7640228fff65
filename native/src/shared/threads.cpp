// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <cstdlib>
#include <mimetic/shared/threads.hpp>
#include <opencv2/core/utility.hpp>
#include <string_view>

namespace mimetic {

void follow_thread_limit() {
    constexpr int kMostThreads = 1024;
    const char* const text = std::getenv("OPENCV_FOR_THREADS_NUM");
    if (text == nullptr) return;
    const std::string_view digits = text;
    int limit = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), limit);
    const bool is_whole = error == std::errc() && end == digits.data() + digits.size();
    if (is_whole && limit >= 1 && limit <= kMostThreads) cv::setNumThreads(limit);
}

}  // namespace mimetic
