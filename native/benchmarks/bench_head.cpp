// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of the head tracker at 320 x 240, beside its floor: the flow alone of a crop of its size. The
// tracker without reference textures is the paper's own form.
#include <benchmark/benchmark.h>

#include <mimetic/head/head.hpp>

#include "../../tests/native/head/head_scene.hpp"

namespace {

using mimetic::test::HeadScene;

const HeadScene& scene() {
    static const HeadScene made(false);
    return made;
}

void advance(benchmark::State& state, mimetic::HeadModel model, int max_key_views, bool fast = false) {
    std::vector<std::vector<std::uint8_t>> frames;
    for (int frame = 0; frame < 8; ++frame) {
        frames.push_back(scene().render(HeadScene::motion(frame)));
    }
    mimetic::HeadOptions options;
    options.max_key_views = max_key_views;
    options.fast = fast;
    const auto shape = mimetic::make_head_shape(model, scene().vertices, scene().faces);
    mimetic::HeadTracker tracker(scene().camera, shape, scene().view(frames[0]), HeadScene::motion(0),
                                 options);
    std::size_t frame = 0;
    for (auto _ : state) {
        // There and back, so that every frame is next to the one before
        const std::size_t place = ++frame % 14;
        benchmark::DoNotOptimize(tracker.advance(scene().view(frames[place < 8 ? place : 14 - place])));
    }
}

void floor_flow(benchmark::State& state) {
    constexpr int kRows = 168, kCols = 122;  // the head's box at the default crop_height, with its margin
    std::vector<std::uint8_t> image(kRows * kCols);
    for (std::size_t k = 0; k < image.size(); ++k) {
        image[k] = static_cast<std::uint8_t>(k * k / 7);
    }
    mimetic::FlowOptions options;
    options.method = mimetic::HeadOptions{}.flow_method;
    const mimetic::GrayView view{image.data(), kRows, kCols, kCols};
    for (auto _ : state) {
        benchmark::DoNotOptimize(mimetic::compute_flow(view, view, options));
    }
}

constexpr int kKeyViews = 24;
BENCHMARK_CAPTURE(advance, ellipsoid, mimetic::HeadModel::ellipsoid, kKeyViews)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(advance, plane, mimetic::HeadModel::plane, kKeyViews)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(advance, surface, mimetic::HeadModel::surface, kKeyViews)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(advance, ellipsoid_fast, mimetic::HeadModel::ellipsoid, kKeyViews, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(advance, surface_fast, mimetic::HeadModel::surface, kKeyViews, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(advance, flow_regularised, mimetic::HeadModel::ellipsoid, 0)->Unit(benchmark::kMillisecond);
BENCHMARK(floor_flow)->Unit(benchmark::kMillisecond);

}  // namespace
