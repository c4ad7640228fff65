// SPDX-License-Identifier: GPL-3.0-or-later
// The networks for eyes and mouth on one crop, beside cutting the crop out alone as the floor.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <mimetic/locate/feature_networks.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace {

constexpr int kRows = 480;
constexpr int kCols = 640;

cv::Mat3b noise_image() {
    cv::Mat3b image(kRows, kCols);
    cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(image, image, {0, 0}, 2);
    return image;
}

mimetic::ColorView view(const cv::Mat3b& image) {
    return {image.data, image.rows, image.cols, static_cast<std::ptrdiff_t>(image.step)};
}

/// The networks in MIMETIC_DATA, where `scripts/make_networks` leaves them otherwise. eye_points: file of the
/// regressor of lids, empty for none.
mimetic::FeatureNetworks networks(const std::string& eye_points = {}) {
    const char* chosen = std::getenv("MIMETIC_DATA");
    const std::string folder = chosen ? chosen : "build/data";
    return {folder + "/face_mesh.onnx",
            folder + "/iris_landmark.onnx",
            {folder + "/face_lips.onnx",
             {folder + "/face_eye_left.onnx", folder + "/face_eye_right.onnx"},
             eye_points}};
}

void face(benchmark::State& state, bool refine_eyes) {
    const cv::Mat3b image = noise_image();
    const mimetic::FeatureNetworks nets = networks();
    for (auto _ : state)
        benchmark::DoNotOptimize(nets.mesh(view(image), {{320, 240}, 280, 0.1}, refine_eyes));
}

void both_eyes(benchmark::State& state, const char* eye_points) {
    const cv::Mat3b image = noise_image();
    const mimetic::FeatureNetworks nets = networks(eye_points);
    for (auto _ : state) {
        benchmark::DoNotOptimize(nets.eye(view(image), {{360, 240}, 90, 0.1}, true));
        benchmark::DoNotOptimize(nets.eye(view(image), {{280, 240}, 90, 0.1}, false));
    }
}

void floor_crop(benchmark::State& state) {
    const cv::Mat3b image = noise_image();
    const cv::Matx23d warp(1.4, -0.1, 180, 0.1, 1.4, 100);
    cv::Mat square;
    for (auto _ : state) {
        cv::warpAffine(image, square, warp, {192, 192}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                       cv::BORDER_REPLICATE);
        benchmark::DoNotOptimize(square.data);
    }
}

BENCHMARK_CAPTURE(face, mesh_and_lips, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(face, mesh_lips_and_eyes, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(both_eyes, network_alone, "")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(both_eyes, with_regressor, "native/data/eye_points.onnx")->Unit(benchmark::kMillisecond);
BENCHMARK(floor_crop)->Unit(benchmark::kMillisecond);

}  // namespace
