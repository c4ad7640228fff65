// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <cstdlib>
#include <memory>
#include <mimetic/shared/threads.hpp>
#include <opencv2/core/parallel/parallel_backend.hpp>
#include <opencv2/core/utility.hpp>
#include <string_view>

namespace mimetic {

namespace {

/// Runs all stripes of a loop one after the other.
class OneThread : public cv::parallel::ParallelForAPI {
public:
    void parallel_for(int tasks, FN_parallel_for_body_cb_t body, void* data) override {
        body(0, tasks, data);
    }
    int getThreadNum() const override { return 0; }
    int getNumThreads() const override { return 2; }
    int setNumThreads(int) override { return 2; }
    const char* getName() const override { return "one thread"; }
};

/// Of the environment; 0: none.
int thread_limit() {
    constexpr int kMostThreads = 1024;
    const char* const text = std::getenv("OPENCV_FOR_THREADS_NUM");
    if (text == nullptr) return 0;
    const std::string_view digits = text;
    int limit = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), limit);
    const bool is_whole = error == std::errc() && end == digits.data() + digits.size();
    return is_whole && limit >= 1 && limit <= kMostThreads ? limit : 0;
}

}  // namespace

void follow_thread_limit() {
    const int limit = thread_limit();
    if (limit > 1) cv::setNumThreads(limit);
    if (limit == 1 || cv::getNumThreads() == 1) {
        cv::setNumThreads(2);  // or OpenCV would not ask whom to run its loops by
        cv::parallel::setParallelForBackend(std::make_shared<OneThread>(), false);
    }
}

}  // namespace mimetic
