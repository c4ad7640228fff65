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

    static double contrast(const Grey& grey, const Points& points, int most_height = 300) {
        std::vector<std::uint8_t> pixels;
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kCols; ++x) {
                const double value = std::clamp(std::round(grey(x, y)), 0., 255.);
                pixels.insert(pixels.end(), 3, static_cast<std::uint8_t>(value));
            }
        }
        return fine_contrast({pixels.data(), kRows, kCols, 3 * kCols}, kCamera, points, most_height);
    }

    static Grey noise(double deviation) {
        return [deviation, random = std::mt19937(7)](int, int) mutable {
            return 128 + std::normal_distribution<>(0, deviation)(random);
        };
    }

    /// Waves along both axes, this many pixels long.
    static Grey waves(double length, double amplitude) {
        return [=](int x, int y) {
            const double turn = 2 * std::numbers::pi / length;
            return 128 + amplitude * (std::sin(turn * (x + .3)) * std::sin(turn * (y + .7)));
        };
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
        const double now =
            contrast([&, fine = noise(deviation)](int x, int y) { return smooth(x, y) + fine(x, y) - 128; },
                     face(100, 140));
        EXPECT_GT(now, 1.3 * before);
        before = now;
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
    EXPECT_THROW(fine_contrast({small.data(), 20, 20, 60}, kCamera, face(100, 140), 300), InvalidInput);
}

}  // namespace
}  // namespace mimetic
