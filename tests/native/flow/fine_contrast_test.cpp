// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <mimetic/flow/fine_contrast.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <random>
#include <vector>

namespace mimetic {
namespace {

constexpr int kRows = 200, kCols = 160;
constexpr double kFocal = 200;
const Camera kCamera{kFocal, kFocal, kCols / 2., kRows / 2., kCols, kRows};

using Grey = std::function<double(int x, int y)>;

class FineContrastTest : public ::testing::Test {
protected:
    /// Corners of a face of so many pixels in the middle of the picture.
    static Points face(double width, double height) {
        Points points(2, 3);
        points << -width / 2, -height / 2, kFocal, width / 2, height / 2, kFocal;
        return points / kFocal;
    }

    static std::vector<std::uint8_t> drawn(const Grey& grey) {
        std::vector<std::uint8_t> pixels;
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kCols; ++x) {
                const double value = std::clamp(std::round(grey(x, y)), 0., 255.);
                pixels.insert(pixels.end(), 3, static_cast<std::uint8_t>(value));
            }
        }
        return pixels;
    }

    static double contrast(const Grey& grey, const Grey& next, const Points& points, int most_height = 300) {
        const auto first = drawn(grey);
        const auto second = drawn(next);
        return fine_contrast(view(first), view(second), kCamera, points, most_height);
    }

    /// Of a picture that stays as it is.
    static double contrast(const Grey& grey, const Points& points, int most_height = 300) {
        const auto pixels = drawn(grey);
        return fine_contrast(view(pixels), view(pixels), kCamera, points, most_height);
    }

    static ColorView view(const std::vector<std::uint8_t>& pixels) {
        return {pixels.data(), kRows, kCols, 3 * kCols};
    }

    static Grey noise(double deviation, unsigned seed = 7) {
        return [deviation, random = std::mt19937(seed)](int, int) mutable {
            return 128 + std::normal_distribution<>(0, deviation)(random);
        };
    }

    /// Waves along both axes, this many pixels long, moved by as many to the left.
    static Grey waves(double length, double amplitude, double moved = 0) {
        return [=](int x, int y) {
            const double turn = 2 * std::numbers::pi / length;
            return 128 + amplitude * (std::sin(turn * (x + .3 + moved)) * std::sin(turn * (y + .7)));
        };
    }

    static Grey sum(Grey one, Grey other) {
        return [one = std::move(one), other = std::move(other)](int x, int y) {
            return one(x, y) + other(x, y) - 128;
        };
    }

    /// As a face's: of long waves and of short ones.
    static Grey texture(double moved = 0) {
        return sum(waves(37, 50, moved), sum(waves(3.6, 12, moved), waves(11, 20, moved)));
    }
};

TEST_F(FineContrastTest, WhiteNoiseHasAllThereIs) {
    EXPECT_NEAR(contrast(noise(20), face(100, 140)), 1, .05);
}

TEST_F(FineContrastTest, LongWavesHaveLittleWhateverTheirContrast) {
    EXPECT_LT(contrast(waves(30, 80), face(100, 140)), .08);
    EXPECT_NEAR(contrast(waves(12, 80), face(100, 140)), contrast(waves(12, 20), face(100, 140)), .02);
    EXPECT_LT(contrast(waves(24, 60), face(100, 140)), contrast(waves(12, 60), face(100, 140)) / 2);
    EXPECT_LT(contrast([](int, int) { return 90; }, face(100, 140)), 1e-6);
}

TEST_F(FineContrastTest, GrowsWithWhatIsFineAmongLongWaves) {
    const Grey smooth = waves(30, 60);
    double before = contrast(smooth, face(100, 140));
    for (const double deviation : {5., 12., 30.}) {
        const double now = contrast(sum(smooth, noise(deviation)), face(100, 140));
        EXPECT_GT(now, 1.3 * before);
        before = now;
    }
}

TEST_F(FineContrastTest, NoiseThatIsNewInEachFrameHasNone) {
    EXPECT_LT(contrast(noise(20), noise(20, 8), face(100, 140)), .2);
    const double bare = contrast(texture(), face(100, 140));
    const double noisy = contrast(sum(texture(), noise(6)), sum(texture(), noise(6, 8)), face(100, 140));
    EXPECT_GT(bare, .2);
    EXPECT_NEAR(noisy, bare, .3 * bare);
}

TEST_F(FineContrastTest, WhatIsFineCountsWhereItMoves) {
    const double still = contrast(texture(), face(100, 140));
    for (const double moved : {.25, .5, 1.7, 6.3}) {
        EXPECT_GT(contrast(texture(), texture(moved), face(100, 140)), .75 * still) << moved;
    }
}

TEST_F(FineContrastTest, LooksAtTheFaceAlone) {
    const auto in_front_of_noise = [smooth = waves(30, 80), fine = noise(30)](int x, int y) {
        const bool is_face = std::abs(x - kCols / 2) < 50 && std::abs(y - kRows / 2) < 70;
        return is_face ? smooth(x, y) : fine(x, y);
    };
    EXPECT_LT(contrast(in_front_of_noise, face(100, 140)), .08);
    EXPECT_GT(contrast(in_front_of_noise, face(300, 400)), .2);
}

TEST_F(FineContrastTest, ALargeFaceIsJudgedAtTheSizeItIsScaledTo) {
    const Grey checks = [](int x, int y) { return (x + y) % 2 == 0 ? 100 : 150; };
    EXPECT_NEAR(contrast(checks, face(100, 160)), 2, .01);
    EXPECT_LT(contrast(checks, face(100, 160), 80), .05);
    EXPECT_GT(contrast(waves(24, 80), face(100, 160), 80), 2 * contrast(waves(24, 80), face(100, 160)));
}

TEST_F(FineContrastTest, NothingWhereLessThanABlockIsSeen) {
    EXPECT_EQ(contrast(noise(20), face(10, 10)), 0);
    Points beside = face(100, 140);
    beside.col(0).array() += 5;
    EXPECT_EQ(contrast(noise(20), beside), 0);
}

TEST_F(FineContrastTest, SaysWhatIsWrong) {
    Points behind = face(100, 140);
    behind(1, 2) = -1;
    EXPECT_THROW(contrast(noise(20), behind), InvalidInput);
    EXPECT_THROW(contrast(noise(20), Points(0, 3)), InvalidInput);
    EXPECT_THROW(contrast(noise(20), face(100, 140), 0), InvalidInput);
    const std::vector<std::uint8_t> small(std::size_t{3} * 20 * 20);
    const ColorView other{small.data(), 20, 20, 60};
    const auto pixels = drawn(noise(20));
    EXPECT_THROW(fine_contrast(other, view(pixels), kCamera, face(100, 140), 300), InvalidInput);
    EXPECT_THROW(fine_contrast(view(pixels), other, kCamera, face(100, 140), 300), InvalidInput);
}

}  // namespace
}  // namespace mimetic
