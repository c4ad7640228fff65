// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/puppet/match.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>

#include "../flow/textures.hpp"

namespace mimetic {
namespace {

/// A picture of smooth waves, `scale` times as large and turned clockwise about the pixel (160, 120).
GrayPicture waves(unsigned seed, double scale = 1, double rotation = 0, double gain = 1, double offset = 0) {
    const auto texture = testing::make_texture(seed, 40);
    GrayPicture picture{240, 320, {}};
    const double c = std::cos(rotation) / scale, s = std::sin(rotation) / scale;
    for (int y = 0; y < picture.rows; ++y) {
        for (int x = 0; x < picture.cols; ++x) {
            const double from_x = 160 + c * (x - 160) + s * (y - 120);
            const double from_y = 120 - s * (x - 160) + c * (y - 120);
            const double value = offset + gain * texture(from_x, from_y);
            picture.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(value), 0., 255.)));
        }
    }
    return picture;
}

GrayPicture cut(const GrayPicture& from, int x, int y, int rows, int cols) {
    GrayPicture picture{rows, cols, {}};
    for (int row = y; row < y + rows; ++row) {
        const std::uint8_t* start = from.view().row(row) + x;
        picture.pixels.insert(picture.pixels.end(), start, start + cols);
    }
    return picture;
}

LookTemplate look(const GrayPicture& from, int x, int y, int rows, int cols, int group = 0) {
    return {cut(from, x, y, rows, cols), {x + .5 * (cols - 1), y + .5 * (rows - 1)}, group};
}

cv::Mat1b mat(const GrayPicture& picture) {
    return cv::Mat1b(picture.rows, picture.cols, const_cast<std::uint8_t*>(picture.pixels.data()));
}

double brute_force(const GrayView& image, const GrayView& picture, int x, int y) {
    double mean_i = 0, mean_t = 0;
    const int n = picture.rows * picture.cols;
    for (int r = 0; r < picture.rows; ++r) {
        for (int c = 0; c < picture.cols; ++c) {
            mean_i += double(image.row(y + r)[x + c]) / n;
            mean_t += double(picture.row(r)[c]) / n;
        }
    }
    double shared = 0, own_i = 0, own_t = 0;
    for (int r = 0; r < picture.rows; ++r) {
        for (int c = 0; c < picture.cols; ++c) {
            const double i = image.row(y + r)[x + c] - mean_i, t = picture.row(r)[c] - mean_t;
            shared += i * t;
            own_i += i * i;
            own_t += t * t;
        }
    }
    return shared / std::sqrt(own_i * own_t);
}

class SizesTest : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(SizesTest, CorrelationIsTheDefinitionsAndOpenCvs) {
    const auto [rows, cols] = GetParam();
    const GrayPicture image = waves(1), picture = cut(waves(2), 50, 60, rows, cols);
    const MatrixRows map = correlation_map(image.view(), picture.view());
    ASSERT_EQ(map.rows(), 240 - rows + 1);
    ASSERT_EQ(map.cols(), 320 - cols + 1);
    cv::Mat1f expected;
    cv::matchTemplate(mat(image), mat(picture), expected, cv::TM_CCOEFF_NORMED);
    double apart = 0;
    for (int y = 0; y < map.rows(); ++y) {
        for (int x = 0; x < map.cols(); ++x) {
            apart = std::max(apart, std::abs(map(y, x) - double(expected(y, x))));
            if (x % 37 == 0 && y % 41 == 0) {
                EXPECT_NEAR(map(y, x), brute_force(image.view(), picture.view(), x, y), 1e-6);
            }
        }
    }
    EXPECT_LT(apart, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SizesTest,
                         ::testing::Values(std::pair{24, 24}, std::pair{9, 37}, std::pair{120, 100},
                                           std::pair{16, 1}, std::pair{128, 128}));

TEST(CorrelationMap, IsZeroWhereTheImageIsFlat) {
    const GrayPicture flat{40, 40, std::vector<std::uint8_t>(1600, 90)};
    EXPECT_EQ(correlation_map(flat.view(), cut(waves(1), 0, 0, 12, 12).view()).cwiseAbs().maxCoeff(), 0);
}

TEST(TemplateMatcher, FindsWhatWasCutOutWhateverTheLight) {
    const GrayPicture image = waves(3);
    TemplateMatcher matcher({look(image, 100, 90, 24, 24), look(image, 140, 110, 90, 80, 1)});
    for (const auto& [gain, offset] : {std::pair{1., 0.}, std::pair{.6, 10.}, std::pair{.5, 90.}}) {
        const auto matches = matcher.match(waves(3, 1, 0, gain, offset).view());
        EXPECT_GT(matches[0].score, .998) << gain;
        EXPECT_NEAR(matches[0].place.x(), 111.5, .05);
        EXPECT_NEAR(matches[0].place.y(), 101.5, .05);
        // At a quarter of its size, half a pixel of that beside the image's
        EXPECT_GT(matches[1].score, .95);
        EXPECT_NEAR(matches[1].place.x(), 179.5, .3);
        EXPECT_NEAR(matches[1].place.y(), 154.5, .3);
    }
}

TEST(TemplateMatcher, MeasuresShiftsOfPartsOfAPixel) {
    const auto texture = testing::make_texture(5, 40);
    const auto moved = [&](double x_shift, double y_shift) {
        GrayPicture picture{120, 160, {}};
        for (int y = 0; y < 120; ++y) {
            for (int x = 0; x < 160; ++x) {
                picture.pixels.push_back(static_cast<std::uint8_t>(
                    std::clamp(std::round(texture(x - x_shift, y - y_shift)), 0., 255.)));
            }
        }
        return picture;
    };
    TemplateMatcher matcher({look(moved(0, 0), 60, 50, 24, 24)});
    for (const double shift : {.2, .5, -.3, 1.7, -4.4}) {
        const auto match = matcher.match(moved(shift, -shift).view())[0];
        EXPECT_NEAR(match.place.x(), 71.5 + shift, .1);
        EXPECT_NEAR(match.place.y(), 61.5 - shift, .1);
    }
}

TEST(TemplateMatcher, SearchesCoarseFirstAndFindsWhatAnExhaustiveSearchFinds) {
    MatchOptions options;
    options.scales = {1 / 1.15, 1, 1.15};
    options.rotations = {-.17, 0, .17};
    const GrayPicture reference = waves(7);
    for (const double scale : {1 / 1.15, 1., 1.15}) {
        for (const double rotation : {-.17, 0., .17}) {
            TemplateMatcher matcher({look(reference, 148, 108, 24, 24)}, options);
            const auto match = matcher.match(waves(7, scale, rotation).view())[0];
            EXPECT_GT(match.score, .97) << scale << " " << rotation;
            EXPECT_EQ(match.scale, scale);
            EXPECT_EQ(match.rotation, rotation);
            EXPECT_NEAR(match.place.x(), 159.5, .5);
            EXPECT_NEAR(match.place.y(), 119.5, .5);
        }
    }
}

TEST(TemplateMatcher, FollowsAPartAndSearchesEverywhereForALostOne) {
    const GrayPicture image = waves(9);
    const LookTemplate first = look(image, 40, 40, 40, 40), second = look(image, 90, 44, 20, 20, 1);
    TemplateMatcher matcher({first, second});
    const auto shifted = [&](int by) {
        GrayPicture picture{240, 320, {}};
        for (int y = 0; y < 240; ++y) {
            for (int x = 0; x < 320; ++x) {
                picture.pixels.push_back(image.view().row(y)[(x - by + 320) % 320]);
            }
        }
        return picture;
    };
    for (int by = 0; by <= 40; by += 10) {  // each within the window about the last place
        const auto matches = matcher.match(shifted(by).view());
        EXPECT_NEAR(matches[0].place.x(), 59.5 + by, .3);
        EXPECT_NEAR(matches[1].place.x(), 99.5 + by, .3);
        EXPECT_FALSE(matches[0].found_again);
    }
    const auto matches = matcher.match(shifted(160).view());  // far away: both are found by the larger one
    EXPECT_NEAR(matches[0].place.x(), 219.5, .3);
    EXPECT_NEAR(matches[1].place.x(), 259.5, .3);
    EXPECT_TRUE(matches[0].found_again);
    EXPECT_GT(matches[1].score, .99);
}

TEST(TemplateMatcher, NeedsNoSumsOutsideOfItsWindows) {
    // The best place is at the edge of the search window, for every parity of sides and places
    MatchOptions options;
    options.scales = {.9, 1, 1.12};
    options.rotations = {-.1, 0, .1};
    const GrayPicture image = waves(13);
    for (int i = 0; i < 24; ++i) {
        options.search_radius = 3 + i % 5;
        LookTemplate moved = look(image, 100 + i, 80 + i % 3, 21 + i % 4, 22 + i % 3);
        moved.place +=
            Eigen::Vector2d((i % 2 ? 1 : -1) * options.search_radius, (i % 3 - 1) * options.search_radius);
        TemplateMatcher matcher({moved}, options);
        const auto match = matcher.match(image.view())[0];
        EXPECT_GT(match.score, .9) << i;  // at the edge another size may fit better
    }
}

TEST(TemplateMatcher, LeavesWindowsInPlaceInAStabilisedPicture) {
    const GrayPicture image = waves(9);
    MatchOptions options;
    options.follow = false;
    options.search_radius = 4;
    TemplateMatcher matcher({look(image, 40, 40, 24, 24)}, options);
    const GrayPicture other = waves(11);
    for (int repeat = 0; repeat < 3; ++repeat) {
        const auto match = matcher.match(other.view())[0];
        EXPECT_LE(std::abs(match.place.x() - 51.5), 4.5);
        EXPECT_LE(std::abs(match.place.y() - 51.5), 4.5);
    }
}

TEST(TemplateMatcher, TakesImagesSmallerThanItsTemplatesAndRefusesNonsense) {
    const GrayPicture image = waves(1);
    TemplateMatcher matcher({look(image, 40, 40, 80, 80)});
    EXPECT_LE(matcher.match(cut(image, 0, 0, 40, 40).view())[0].score, -1);
    EXPECT_THROW(TemplateMatcher({}), InvalidInput);
    EXPECT_THROW(TemplateMatcher({{{8, 8, {}}, {0, 0}, 0}}), InvalidInput);
    EXPECT_THROW(TemplateMatcher({{{4, 8, std::vector<std::uint8_t>(32)}, {0, 0}, 0}}), InvalidInput);
    MatchOptions options;
    options.scales = {5};
    EXPECT_THROW(TemplateMatcher({look(image, 0, 0, 20, 20)}, options), InvalidInput);
}

}  // namespace
}  // namespace mimetic
