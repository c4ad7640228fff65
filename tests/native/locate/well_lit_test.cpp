// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/locate/well_lit.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <vector>

namespace mimetic {
namespace {

constexpr int kWidth = 200, kHeight = 160, kSkin = 160, kMark = 60;
const FeatureCrop kFace{{100, 80}, 120, 0};

/// Skin of one grey with dark marks, 8 pixels wide and 20 apart; light falls off over 20 pixels in the
/// middle, to `dark` on the right.
std::vector<std::uint8_t> half_lit(double dark) {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const double light = 1 + (dark - 1) * std::clamp((x - 90) / 20., 0., 1.);
            const double grey = light * (x % 20 < 8 && y % 20 < 8 ? kMark : kSkin);
            pixels.insert(pixels.end(), 3, static_cast<std::uint8_t>(std::lround(grey)));
        }
    }
    return pixels;
}

ColorView view_of(const std::vector<std::uint8_t>& pixels) {
    return {pixels.data(), kHeight, kWidth, 3 * kWidth};
}

TEST(WellLit, LeavesAWellLitFaceAlone) {
    for (const double dark : {1., .8}) {
        const auto pixels = half_lit(dark);
        EXPECT_FALSE(well_lit(view_of(pixels), kFace));
    }
}

TEST(WellLit, RaisesTheDarkHalfAndKeepsItsMarks) {
    const auto pixels = half_lit(.2);
    const auto lit = well_lit(view_of(pixels), kFace);
    ASSERT_TRUE(lit);
    const int bright_skin = lit->view().row(70)[3 * 70], dark_skin = lit->view().row(70)[3 * 130];
    const int dark_mark = lit->view().row(62)[3 * 142];
    EXPECT_NEAR(bright_skin, kSkin, 16);
    EXPECT_NEAR(dark_skin, kSkin, 40);  // not .2 of it
    EXPECT_LT(dark_mark, .65 * dark_skin);
    // Little is added at once as a face becomes uneven: nothing jumps from frame to frame
    const auto little = half_lit(.62);
    const auto raised = well_lit(view_of(little), kFace);
    ASSERT_TRUE(raised);
    EXPECT_LT(raised->view().row(70)[3 * 130], 1.2 * little[3 * (70 * kWidth + 130)]);
}

TEST(WellLit, MakesADimFaceBrighter) {
    std::vector<std::uint8_t> pixels = half_lit(1);
    for (std::uint8_t& value : pixels) value = static_cast<std::uint8_t>(value / 12);
    const auto lit = well_lit(view_of(pixels), kFace);
    ASSERT_TRUE(lit);
    const int skin = lit->view().row(70)[3 * 70], mark = lit->view().row(62)[3 * 142];
    EXPECT_GT(skin, 50);  // of 13
    EXPECT_LT(mark, .6 * skin);
}

/// Skin with marks whose grey values vary by a few levels, each channel multiplied and raised.
std::vector<std::uint8_t> filmed_in(const std::array<double, 3>& gain, double veil = 0) {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const bool is_mark = x % 20 < 8 && y % 20 < 8;
            const double grey = (is_mark ? kMark : kSkin) + (x * 7 + y * 11) % 5;
            for (const double share : gain) {
                pixels.push_back(static_cast<std::uint8_t>(std::lround(std::min(255., share * grey + veil))));
            }
        }
    }
    return pixels;
}

/// Levels of the green channel between skin and marks, where nothing is left of a colour.
int contrast_in(const ColorImage& picture) {
    const auto pixel = [&](int x) { return picture.view().row(66) + 3 * x; };
    EXPECT_EQ(pixel(70)[0], pixel(70)[2]);
    return pixel(70)[1] - pixel(64)[1];
}

TEST(WellLit, ShowsAFaceInBlueLightByItsBlueAlone) {
    EXPECT_FALSE(well_lit(view_of(filmed_in({1, .9, .75})), kFace));
    for (const std::array gain : {std::array{.03, .05, 1.}, std::array{0., 0., .9}}) {
        const auto pixels = filmed_in(gain);
        const auto lit = well_lit(view_of(pixels), kFace);
        ASSERT_TRUE(lit);
        EXPECT_NEAR(contrast_in(*lit), gain[2] * (kSkin - kMark), 8);
        const ColorImage searched = with_raised_shadows(view_of(pixels));
        EXPECT_GT(contrast_in(searched), .7 * (kSkin - kMark));
    }
}

TEST(WellLit, ShowsAFaceInFogWithUsualContrast) {
    EXPECT_FALSE(well_lit(view_of(filmed_in({.7, .7, .7}, 40)), kFace));
    for (const double left : {.25, .12, .06}) {
        const auto pixels = filmed_in({left, left, left}, 180);
        const auto lit = well_lit(view_of(pixels), kFace);
        ASSERT_TRUE(lit);
        EXPECT_GT(contrast_in(*lit), 60);  // of 25, 12 and 6
        EXPECT_GT(contrast_in(with_raised_shadows(view_of(pixels))), 60);
    }
    // Little at once as fog comes
    const auto thin = filmed_in({.4, .4, .4}, 118);
    const auto cleared = well_lit(view_of(thin), kFace);
    ASSERT_TRUE(cleared);
    EXPECT_LT(contrast_in(*cleared), 1.3 * .4 * (kSkin - kMark));
}

TEST(WellLit, LeavesASurfaceOfOneColourAlone) {
    const std::vector<std::uint8_t> pixels(3UL * kWidth * kHeight, 140);
    EXPECT_FALSE(well_lit(view_of(pixels), kFace));
}

TEST(WellLit, FollowsALeantFace) {
    FeatureCrop leant = kFace;
    leant.roll = std::numbers::pi / 2;  // its halves lie above each other, lit alike
    const auto pixels = half_lit(.3);
    EXPECT_TRUE(well_lit(view_of(pixels), kFace));
    EXPECT_FALSE(well_lit(view_of(pixels), leant));
}

TEST(WellLit, SaysNothingBesideThePicture) {
    const auto pixels = half_lit(.2);
    FeatureCrop beside = kFace;
    beside.center.x() = 5000;
    EXPECT_FALSE(well_lit(view_of(pixels), beside));
    beside.side = std::nan("");
    EXPECT_THROW(well_lit(view_of(pixels), beside), InvalidInput);
}

TEST(WellLit, RaisesAllShadowsToLookForAFace) {
    const auto pixels = half_lit(.1);
    const ColorImage raised = with_raised_shadows(view_of(pixels));
    EXPECT_GT(raised.view().row(70)[3 * 190], 3 * pixels[3 * (70 * kWidth + 190)]);
    EXPECT_NEAR(raised.view().row(70)[3 * 10], kSkin, 16);
}

}  // namespace
}  // namespace mimetic
