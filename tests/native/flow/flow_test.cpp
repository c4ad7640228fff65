// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/error.hpp>

#include "textures.hpp"

namespace mimetic {
namespace {

using testing::Image;
using testing::make_texture;
using testing::Motion;
using testing::render;
using testing::still;

constexpr int kRows = 120;
constexpr int kCols = 160;
constexpr int kBorder = 10;
constexpr double kNoise = 2.5;  // grey levels, a webcam's

struct Errors {
    double median_px;
    double normalised;  // mean of e^T covariance^-1 e: 2 for an honest covariance
};

Eigen::Vector2d flow_at(const FlowField& field, int y, int x) {
    return {field.flow_at(y, x)[0], field.flow_at(y, x)[1]};
}

Eigen::Matrix2d covariance_at(const FlowField& field, int y, int x) {
    const float* c = field.covariance_at(y, x);
    return (Eigen::Matrix2d() << c[0], c[1], c[1], c[2]).finished();
}

Errors measure(const FlowField& field, const Motion& motion) {
    std::vector<double> errors;
    double normalised = 0;
    for (int y = kBorder; y < field.rows - kBorder; ++y) {
        for (int x = kBorder; x < field.cols - kBorder; ++x) {
            const Eigen::Vector2d error = flow_at(field, y, x) - motion(x, y);
            errors.push_back(error.norm());
            normalised += error.dot(covariance_at(field, y, x).inverse() * error);
        }
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                     errors.end());
    return {errors[errors.size() / 2], normalised / static_cast<double>(errors.size())};
}

Eigen::Vector2d sideways(double, double) { return {1.4, -0.6}; }
Eigen::Vector2d turn_and_grow(double x, double y) {
    return {0.02 * (x - 80) - 0.03 * (y - 60), 0.03 * (x - 80) + 0.02 * (y - 60)};
}
Eigen::Vector2d bulge(double x, double y) {
    const double r2 = (x - 90) * (x - 90) + (y - 50) * (y - 50);
    return Eigen::Vector2d(0.5, -2.5) * std::exp(-r2 / (2 * 20 * 20));
}
Eigen::Vector2d far_away(double, double) { return {7.5, -5.0}; }

class Flow : public ::testing::TestWithParam<FlowMethod> {
protected:
    FlowOptions options() const {
        FlowOptions options;
        options.method = GetParam();
        return options;
    }
    Errors run(const Motion& motion, unsigned seed, double contrast = 35) const {
        const auto texture = make_texture(seed, contrast);
        const Image from = render(texture, still, kRows, kCols, kNoise, seed + 100);
        const Image to = render(texture, motion, kRows, kCols, kNoise, seed + 200);
        return measure(compute_flow(from.view(), to.view(), options()), motion);
    }
};

TEST_P(Flow, MeetsKnownMotionsWithinAFractionOfAPixel) {
    EXPECT_LT(run(sideways, 1).median_px, 0.15);
    EXPECT_LT(run(turn_and_grow, 2).median_px, 0.15);
    EXPECT_LT(run(bulge, 3).median_px, 0.15);
    EXPECT_LT(run(far_away, 4).median_px, 0.15);
}

TEST_P(Flow, ShowsNarrowMotionBlurredByItsOwnBlur) {
    const double blur = flow_blur_px(GetParam());
    for (const double width : {6.0, 9.0, 15.0}) {
        const Motion bump = [&](double x, double y) {
            const double r2 = (x - 80) * (x - 80) + (y - 60) * (y - 60);
            return Eigen::Vector2d(0, 1.5 * std::exp(-r2 / (2 * width * width)));
        };
        double shown = 0;
        constexpr int kSeeds = 8;
        for (unsigned seed = 0; seed < kSeeds; ++seed) {
            const auto texture = make_texture(seed + 30, 35);
            const Image from = render(texture, still, kRows, kCols, kNoise, seed + 100);
            const Image to = render(texture, bump, kRows, kCols, kNoise, seed + 200);
            shown += flow_at(compute_flow(from.view(), to.view(), options()), 60, 80).y() / 1.5 / kSeeds;
        }
        RecordProperty("shown_of_" + std::to_string(width), std::to_string(shown));
        EXPECT_NEAR(shown, width * width / (width * width + blur * blur), .15) << width;
    }
}

TEST_P(Flow, CovarianceIsHonestOverMotionsAndContrasts) {
    double sum = 0;
    int count = 0;
    for (const Motion& motion : {Motion(sideways), Motion(turn_and_grow), Motion(bulge)}) {
        for (const double contrast : {12.0, 25.0, 50.0}) {
            const double normalised = run(motion, static_cast<unsigned>(++count), contrast).normalised;
            RecordProperty("normalised_" + std::to_string(count), std::to_string(normalised));
            EXPECT_GT(normalised, 0.25) << "contrast " << contrast;
            EXPECT_LT(normalised, 8.0) << "contrast " << contrast;
            sum += normalised;
        }
    }
    EXPECT_GT(sum / count, 1.0);
    EXPECT_LT(sum / count, 4.0);
}

/// Adds noise in patches of 3 x 3 pixels, as a codec leaves it, of a standard deviation of 2.5 grey levels.
Image in_patches(Image image, unsigned seed) {
    constexpr int kPatch = 3;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, kNoise);
    std::vector<double> noise(static_cast<std::size_t>(image.rows * image.cols));
    std::generate(noise.begin(), noise.end(), [&] { return normal(random); });
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const int patch = y / kPatch * image.cols + x / kPatch;
            auto& pixel = image.pixels[static_cast<std::size_t>(y * image.cols + x)];
            const double value = pixel + noise[static_cast<std::size_t>(patch)];
            pixel = static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
        }
    }
    return image;
}

TEST_P(Flow, CovarianceOwnsUpToNoiseThatDoesNotAverageOut) {
    const auto texture = make_texture(1, 25);
    const FlowField white =
        compute_flow(render(texture, still, kRows, kCols, kNoise, 1).view(),
                     render(texture, sideways, kRows, kCols, kNoise, 2).view(), options());
    const FlowField patches =
        compute_flow(in_patches(render(texture, still, kRows, kCols, 0, 1), 1).view(),
                     in_patches(render(texture, sideways, kRows, kCols, 0, 1), 2).view(), options());
    EXPECT_LT(measure(patches, sideways).normalised, 4.0);
    EXPECT_GT(covariance_at(patches, 60, 80).trace(), 3 * covariance_at(white, 60, 80).trace());
}

TEST_P(Flow, CovarianceGrowsWhereTheImageIsFlat) {
    const auto texture = make_texture(7, 35);
    const auto half_flat = [&](double x, double y) { return x < kCols / 2 ? texture(x, y) : 128.0; };
    const Image from = render(half_flat, still, kRows, kCols, kNoise, 1);
    const Image to = render(half_flat, still, kRows, kCols, kNoise, 2);
    const FlowField field = compute_flow(from.view(), to.view(), options());
    EXPECT_GT(covariance_at(field, 60, 130).trace(), 10 * covariance_at(field, 60, 30).trace());
}

TEST_P(Flow, CovarianceIsLongAlongAnEdge) {
    const auto edge = [](double x, double) { return 128 + 60 * std::tanh((x - 80) / 2); };
    const Image from = render(edge, still, kRows, kCols, 1, 1);
    const Image to = render(edge, still, kRows, kCols, 1, 2);
    const FlowField field = compute_flow(from.view(), to.view(), options());
    const Eigen::Matrix2d covariance = covariance_at(field, 60, 80);
    EXPECT_GT(covariance(1, 1), 20 * covariance(0, 0));
}

TEST_P(Flow, CovarianceGrowsWhereSomethingCoversTheFace) {
    const auto face = make_texture(8, 35);
    const auto hand = make_texture(9, 35);
    const auto covered = [&](double x, double y) { return x > 100 && y > 60 ? hand(x, y) : face(x, y); };
    const Image from = render(face, still, kRows, kCols, kNoise, 1);
    const Image to = render(covered, still, kRows, kCols, kNoise, 2);
    const FlowField field = compute_flow(from.view(), to.view(), options());
    EXPECT_GT(covariance_at(field, 90, 130).trace(), 5 * covariance_at(field, 30, 40).trace());
}

TEST_P(Flow, StartsFromTheFlowThatAModelPredicts) {
    const auto texture = make_texture(5, 35);
    const auto leap = [](double, double) { return Eigen::Vector2d(30, 0); };
    const Image from = render(texture, still, kRows, kCols, kNoise, 1);
    const Image to = render(texture, leap, kRows, kCols, kNoise, 2);
    FlowField initial{kRows, kCols, std::vector<float>(2 * kRows * kCols, 0.0f), {}};
    for (std::size_t i = 0; i < initial.flow.size(); i += 2) {
        initial.flow[i] = 28.8f;
    }
    FlowOptions near = options();
    near.num_levels = 2;
    const FlowField field = compute_flow(from.view(), to.view(), near, &initial);
    for (int y = 20; y < 100; y += 10) {
        for (int x = 20; x < 110; x += 10) {
            EXPECT_LT((flow_at(field, y, x) - Eigen::Vector2d(30, 0)).norm(), 0.5) << x << ", " << y;
        }
    }
}

TEST_P(Flow, StoppingAtHalfTheSizeStillMeetsTheMotion) {
    const auto texture = make_texture(6, 35);
    const Image from = render(texture, still, kRows, kCols, kNoise, 1);
    const Image to = render(texture, turn_and_grow, kRows, kCols, kNoise, 2);
    FlowOptions half = options();
    half.finest_level = 1;
    EXPECT_LT(measure(compute_flow(from.view(), to.view(), half), turn_and_grow).median_px, 0.25);
}

TEST_P(Flow, OddSizesAreFilledToTheLastPixel) {
    const auto texture = make_texture(2, 35);
    const Image from = render(texture, still, 67, 101, kNoise, 1);
    const Image to = render(texture, sideways, 67, 101, kNoise, 2);
    const FlowField field = compute_flow(from.view(), to.view(), options());
    ASSERT_EQ(field.flow.size(), 2U * 67 * 101);
    ASSERT_EQ(field.covariance.size(), 3U * 67 * 101);
    for (const float value : field.flow) {
        EXPECT_TRUE(std::isfinite(value));
    }
    for (int y = 0; y < 67; ++y) {
        for (int x = 0; x < 101; ++x) {
            EXPECT_GT(covariance_at(field, y, x).determinant(), 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, Flow, ::testing::Values(FlowMethod::probabilistic, FlowMethod::dis),
                         [](const auto& method) {
                             return method.param == FlowMethod::dis ? "dis" : "probabilistic";
                         });

TEST(FlowInput, RejectsTinyAndMismatchedImages) {
    const Image large{40, 40, std::vector<std::uint8_t>(1600)};
    const Image other{40, 30, std::vector<std::uint8_t>(1200)};
    const Image tiny{10, 10, std::vector<std::uint8_t>(100)};
    EXPECT_THROW(compute_flow(tiny.view(), tiny.view()), InvalidInput);
    EXPECT_THROW(compute_flow(large.view(), other.view()), InvalidInput);
}

TEST(FlowInput, RejectsAnInitialFlowOfAnotherSizeOrNotFinite) {
    const Image image{40, 40, std::vector<std::uint8_t>(1600)};
    FlowField initial{30, 40, std::vector<float>(2400), {}};
    EXPECT_THROW(compute_flow(image.view(), image.view(), {}, &initial), InvalidInput);
    initial = {40, 40, std::vector<float>(3200, NAN), {}};
    EXPECT_THROW(compute_flow(image.view(), image.view(), {}, &initial), InvalidInput);
}

TEST(FlowInput, RejectsOptionsOutOfRange) {
    const Image image{40, 40, std::vector<std::uint8_t>(1600)};
    FlowOptions options;
    options.temporal_noise = 0;
    EXPECT_THROW(compute_flow(image.view(), image.view(), options), InvalidInput);
}

}  // namespace
}  // namespace mimetic
