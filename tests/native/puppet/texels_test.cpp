// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/puppet/texels.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kSide = 32;

/// Red grows to the right, green downwards; the right half is blue.
std::vector<std::uint8_t> picture() {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            pixels.push_back(static_cast<std::uint8_t>(8 * x));
            pixels.push_back(static_cast<std::uint8_t>(8 * y));
            pixels.push_back(x < kSide / 2 ? 0 : 255);
        }
    }
    return pixels;
}

float at(const Texels& texels, int row, int col, int channel) {
    return texels.values[static_cast<std::size_t>(4 * (row * texels.cols + col) + channel)];
}

TEST(Texels, TurnAPictureUpwardsAndMakeItOpaque) {
    const std::vector<std::uint8_t> pixels = picture();
    const Texels texels = texels_of({pixels.data(), kSide, kSide, 3 * kSide}, 100);
    ASSERT_EQ(texels.rows, kSide);  // never enlarged
    ASSERT_EQ(texels.cols, kSide);
    EXPECT_FLOAT_EQ(at(texels, 0, 3, 0), 24.F / 255);
    EXPECT_FLOAT_EQ(at(texels, 0, 3, 1), 8.F * (kSide - 1) / 255);
    EXPECT_FLOAT_EQ(at(texels, kSide - 1, 20, 1), 0);
    EXPECT_FLOAT_EQ(at(texels, kSide - 1, 20, 2), 1);
    EXPECT_FLOAT_EQ(at(texels, 5, 5, 3), 1);
}

TEST(Texels, AverageWhereAPictureIsMadeSmaller) {
    const std::vector<std::uint8_t> pixels = picture();
    const Texels texels = texels_of({pixels.data(), kSide, kSide, 3 * kSide}, kSide / 2);
    ASSERT_EQ(texels.rows, kSide / 2);
    ASSERT_EQ(texels.cols, kSide / 2);
    EXPECT_NEAR(at(texels, 0, 1, 0), 20. / 255, 1.01 / 255);  // of 16 and 24
    EXPECT_NEAR(at(texels, kSide / 2 - 1, 1, 1), 4. / 255, 1.01 / 255);
}

TEST(Texels, RefuseAWidthThatIsNone) {
    const std::vector<std::uint8_t> pixels = picture();
    EXPECT_THROW(texels_of({pixels.data(), kSide, kSide, 3 * kSide}, 0), InvalidInput);
}

}  // namespace
}  // namespace mimetic
