// SPDX-License-Identifier: GPL-3.0-or-later
// Flow with covariance at 640 x 480, beside OpenCV's DIS alone as the floor.
#include <benchmark/benchmark.h>

#include <mimetic/flow/flow.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace {

constexpr int kRows = 480;
constexpr int kCols = 640;

std::pair<cv::Mat, cv::Mat> make_pair() {
    cv::Mat noise(kRows, kCols, CV_32F);
    cv::Mat image;
    cv::RNG(3).fill(noise, cv::RNG::NORMAL, 128, 60);
    cv::GaussianBlur(noise, noise, {0, 0}, 1.5);
    noise.convertTo(image, CV_8U);
    cv::Mat moved;
    const cv::Mat motion = (cv::Mat_<double>(2, 3) << 1.005, 0.004, 1.3, -0.004, 1.005, -2.1);
    cv::warpAffine(image, moved, motion, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    return {image, moved};
}

mimetic::GrayView view(const cv::Mat& image) { return {image.data, image.rows, image.cols, image.cols}; }

void run(benchmark::State& state, mimetic::FlowMethod method, int finest_level) {
    const auto [from, to] = make_pair();
    mimetic::FlowOptions options;
    options.method = method;
    options.finest_level = finest_level;
    for (auto _ : state) {
        benchmark::DoNotOptimize(mimetic::compute_flow(view(from), view(to), options));
    }
}

void floor_dis(benchmark::State& state, int preset) {
    const auto [from, to] = make_pair();
    const auto dis = cv::DISOpticalFlow::create(preset);
    for (auto _ : state) {
        cv::Mat flow;
        dis->calc(from, to, flow);
        benchmark::DoNotOptimize(flow.data);
    }
}

}  // namespace

BENCHMARK_CAPTURE(run, probabilistic, mimetic::FlowMethod::probabilistic, 0)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(run, probabilistic_half, mimetic::FlowMethod::probabilistic, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(run, dis, mimetic::FlowMethod::dis, 0)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(floor_dis, opencv_fast, cv::DISOpticalFlow::PRESET_FAST)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(floor_dis, opencv_medium, cv::DISOpticalFlow::PRESET_MEDIUM)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
