// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <mimetic/retarget/control_fit.hpp>

namespace mimetic {
namespace {

constexpr int kControls = 52, kSources = 60, kFrames = 720;

/// Displacements that overlap: each source moves a share of the vertices, each control is a sum of sources.
struct Character {
    explicit Character(Eigen::Index num_vertices)
        : sources(MatrixRows::Zero(kSources, 3 * num_vertices)),
          weights(Eigen::VectorXd::Ones(num_vertices)) {
        std::srand(1);
        const Eigen::Index span = 3 * num_vertices / 10;
        for (Eigen::Index s = 0; s < kSources; ++s) {
            const Eigen::Index begin = (s * (3 * num_vertices - span)) / kSources;
            sources.row(s).segment(begin, span).setRandom();
        }
        controls = MatrixRows::Random(kControls, kSources).cwiseMax(.6) * sources;
    }
    MatrixRows sources, controls;
    Eigen::VectorXd weights;
};

MatrixRows unit_ranges(Eigen::Index count) {
    MatrixRows rows = MatrixRows::Zero(count, 2);
    rows.col(1).setOnes();
    return rows;
}

void reading_controls(benchmark::State& state) {
    const Character character(state.range(0));
    for (auto _ : state) {
        const ControlFit fit(character.controls, character.sources, character.weights, unit_ranges(kControls),
                             unit_ranges(kSources));
        benchmark::DoNotOptimize(fit.readable().sum());
    }
}
BENCHMARK(reading_controls)->Arg(5000)->Arg(50000)->Unit(benchmark::kMillisecond);

void fitting_frames(benchmark::State& state) {
    const Character character(5000);
    const ControlFit fit(character.controls, character.sources, character.weights, unit_ranges(kControls),
                         unit_ranges(kSources));
    const MatrixRows values = MatrixRows::Random(kFrames, kSources).cwiseMax(0);
    const MatrixRows none = MatrixRows::Zero(kFrames, kControls);
    for (auto _ : state) {
        benchmark::DoNotOptimize(fit.frames(values, none).sum());
    }
    state.SetItemsProcessed(state.iterations() * kFrames);
}
BENCHMARK(fitting_frames)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mimetic
