// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of the tracker at 320 x 240, beside its floor: the flow of a texture of its size, once.
#include <benchmark/benchmark.h>

#include <mimetic/solve/solve.hpp>

#include "../../tests/native/solve/face_scene.hpp"

namespace {

const mimetic::test::FaceScene& scene() {
    static const mimetic::test::FaceScene made;
    return made;
}

void advance(benchmark::State& state, mimetic::FlowMethod method) {
    const auto reference = scene().render(scene().camera_from_head, scene().rest());
    std::vector<std::vector<std::uint8_t>> frames;
    for (int t = 0; t < 8; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[0] = values[1] = .1 * t;
        Eigen::Isometry3d pose = scene().camera_from_head;
        pose.rotate(Eigen::AngleAxisd(.02 * t, Eigen::Vector3d::UnitY()));
        frames.push_back(scene().render(pose, values));
    }
    mimetic::TrackerOptions options;
    options.flow_method = method;
    mimetic::FaceTracker tracker(scene().camera, scene().surface, scene().motion, scene().view(reference),
                                 scene().camera_from_head, {}, options);
    std::size_t frame = 0;
    for (auto _ : state) {
        // There and back, so that every frame is next to the one before
        const std::size_t place = frame % 14;
        benchmark::DoNotOptimize(tracker.advance(scene().view(frames[place < 8 ? place : 14 - place])));
        ++frame;
    }
}

void floor_flow(benchmark::State& state) {
    const std::vector<std::uint8_t> image(216 * 170, 128);
    mimetic::FlowOptions options;
    options.method = mimetic::FlowMethod::dis;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            mimetic::compute_flow({image.data(), 216, 170, 170}, {image.data(), 216, 170, 170}, options));
    }
}

BENCHMARK_CAPTURE(advance, dis, mimetic::FlowMethod::dis)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(advance, probabilistic, mimetic::FlowMethod::probabilistic)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(floor_flow)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
