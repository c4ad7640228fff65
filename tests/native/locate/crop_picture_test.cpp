// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/crop_picture.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace mimetic {
namespace {

constexpr int kSide = 16, kWidth = 125, kHeight = 121;

/// A picture in which a pixel's red is twice its column, its green twice its row.
std::vector<std::uint8_t> ramps() {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            pixels.insert(pixels.end(),
                          {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(2 * y), 0});
        }
    }
    return pixels;
}

/// How far the crop's pixels are on average from where they belong, along x and y; pixels of the picture.
Eigen::Array2d mean_error(const FeatureCrop& crop) {
    const std::vector<std::uint8_t> pixels = ramps();
    const cv::Mat blob = locate::blob_of({pixels.data(), kWidth, kHeight, 3 * kWidth}, crop, kSide, false);
    Eigen::Array2d sum = Eigen::Array2d::Zero();
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
            const Eigen::Vector2d share((column + .5) / kSide - .5, (row + .5) / kSide - .5);
            const Eigen::Vector2d place = crop.center + crop.side * share;
            for (int channel = 0; channel < 2; ++channel) {
                const int at[] = {0, channel, row, column};
                sum[channel] += 255 * blob.at<float>(at) / 2 - place[channel];
            }
        }
    }
    return sum / (kSide * kSide);
}

TEST(CropPicture, LargeCropsShowPixelsWhereTheyAre) {
    for (const double side : {20., 36., 68.}) {  // as it is, halved once, and twice
        for (double shift = 0; shift < 8; shift += .75) {
            const Eigen::Vector2d center(56 + shift, 55.5 + .6 * shift);
            EXPECT_LT(mean_error({center, side, 0}).abs().maxCoeff(), .3) << side << " at " << shift;
        }
    }
}

}  // namespace
}  // namespace mimetic
