// SPDX-License-Identifier: GPL-3.0-or-later
// 16 templates in a picture of 640 x 480, on one core, beside cv::matchTemplate on the same search: windows
// of 12 pixels about each template's place, without scales and rotations and with three of each.
#include <benchmark/benchmark.h>

#include <mimetic/puppet/match.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

namespace {

constexpr int kRows = 480, kCols = 640, kSide = 24, kRadius = 12;

const cv::Mat1b& picture() {
    static const cv::Mat1b made = [] {
        cv::Mat1b noise(kRows, kCols), smooth;
        cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 256);
        cv::GaussianBlur(noise, smooth, {}, 3);
        cv::normalize(smooth, smooth, 0, 255, cv::NORM_MINMAX);
        return smooth;
    }();
    return made;
}

mimetic::GrayView view() { return {picture().data, kRows, kCols, kCols}; }

/// Parts of a face, 4 x 4 of them, `side` pixels each.
std::vector<mimetic::LookTemplate> looks(int side) {
    std::vector<mimetic::LookTemplate> made;
    for (int i = 0; i < 16; ++i) {
        const cv::Rect at(180 + 70 * (i % 4), 100 + 70 * (i / 4), side, side);
        const cv::Mat1b part = picture()(at).clone();
        made.push_back(
            {{side, side, {part.begin(), part.end()}}, {at.x + .5 * (side - 1), at.y + .5 * (side - 1)}, i});
    }
    return made;
}

mimetic::MatchOptions options(int num_steps) {
    mimetic::MatchOptions made;
    made.search_radius = kRadius;
    if (num_steps == 3) {
        made.scales = {1 / 1.15, 1, 1.15};
        made.rotations = {-.17, 0, .17};
    }
    return made;
}

void ours(benchmark::State& state) {
    mimetic::TemplateMatcher matcher(looks(static_cast<int>(state.range(1))),
                                     options(static_cast<int>(state.range(0))));
    for (auto _ : state) {
        benchmark::DoNotOptimize(matcher.match(view()));
    }
}

/// All windows within the radius, at each of 1 or 9 scales and rotations, at full size.
void opencv(benchmark::State& state) {
    cv::setNumThreads(1);
    const auto templates = looks(static_cast<int>(state.range(1)));
    const auto num_variants = state.range(0) * state.range(0);
    cv::Mat1f scores;
    for (auto _ : state) {
        for (const auto& one : templates) {
            const int side = one.picture.rows;
            const cv::Mat1b part(side, side, const_cast<std::uint8_t*>(one.picture.pixels.data()));
            const cv::Rect window(cvRound(one.place.x() - .5 * side) - kRadius,
                                  cvRound(one.place.y() - .5 * side) - kRadius, side + 2 * kRadius,
                                  side + 2 * kRadius);
            for (int k = 0; k < num_variants; ++k) {
                cv::matchTemplate(picture()(window), part, scores, cv::TM_CCOEFF_NORMED);
                double highest = 0;
                cv::minMaxLoc(scores, nullptr, &highest);
                benchmark::DoNotOptimize(highest);
            }
        }
    }
}

/// A face that jumped: searched for in the whole picture.
void ours_lost(benchmark::State& state) {
    mimetic::TemplateMatcher matcher(looks(static_cast<int>(state.range(1))),
                                     options(static_cast<int>(state.range(0))));
    cv::Mat1b mirrored;
    cv::flip(picture(), mirrored, -1);
    const mimetic::GrayView other{mirrored.data, kRows, kCols, kCols};
    for (auto _ : state) {
        benchmark::DoNotOptimize(matcher.match(other));
    }
}

// Steps of scale and of rotation; pixels a side
BENCHMARK(ours)->Args({1, kSide})->Args({3, kSide})->Args({1, 64})->Unit(benchmark::kMillisecond);
BENCHMARK(opencv)->Args({1, kSide})->Args({3, kSide})->Args({1, 64})->Unit(benchmark::kMillisecond);
BENCHMARK(ours_lost)->Args({1, kSide})->Args({3, kSide})->Unit(benchmark::kMillisecond);

}  // namespace
