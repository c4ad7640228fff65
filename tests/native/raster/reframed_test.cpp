// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/raster/reframed.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

const Camera kCamera{100, 110, 49.5, 39.5, 100, 80};

/// Red grows with x, green with y: 2 levels a pixel.
struct Ramps {
    std::vector<std::uint8_t> pixels;
    Ramps() {
        for (int y = 0; y < 80; ++y) {
            for (int x = 0; x < 100; ++x) {
                pixels.insert(pixels.end(),
                              {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(2 * y), 0});
            }
        }
    }
    ColorView view() const { return {pixels.data(), 80, 100, 300}; }
};

TEST(Reframed, APointOfTheSceneIsWhereTheOtherCamerasPictureHasIt) {
    const Eigen::Vector3d point(.1, -.05, 1.3);
    const Eigen::Vector2d pixel = kCamera.project(point);
    for (const double scale : {.2, .7, 1., 3.}) {
        const Camera other = reframed(kCamera, pixel + Eigen::Vector2d(2, -3), scale, 40, 30);
        const Eigen::Vector2d place = other.project(point);
        EXPECT_NEAR(place.x(), 19.5 - 2 * scale, 1e-9);
        const ColorImage picture = reframed(Ramps().view(), kCamera, other);
        ASSERT_EQ(picture.pixels.size(), 40u * 30 * 3);
        const auto x = static_cast<int>(std::lround(place.x())), y = static_cast<int>(std::lround(place.y()));
        const std::uint8_t* level = picture.pixels.data() + 3 * (40 * y + x);
        EXPECT_NEAR(level[0], 2 * (pixel.x() + (x - place.x()) / scale), 1.6) << scale;
        EXPECT_NEAR(level[1], 2 * (pixel.y() + (y - place.y()) / scale), 1.6) << scale;
    }
}

TEST(Reframed, ItIsBlackWhereThePictureEnds) {
    const Camera other = reframed(kCamera, {0, 0}, 1, 40, 30);
    const ColorImage picture = reframed(Ramps().view(), kCamera, other);
    EXPECT_EQ(picture.pixels[3 * (40 * 20 + 5)], 0);
    EXPECT_GT(picture.pixels[3 * (40 * 20 + 39)], 20);
}

TEST(Reframed, WrongInputIsRefused) {
    EXPECT_THROW(reframed(kCamera, {0, 0}, 0, 40, 30), InvalidInput);
    EXPECT_THROW(reframed(kCamera, {0, 0}, 1, 4, 30), InvalidInput);
    Camera larger = kCamera;
    larger.width = 101;
    EXPECT_THROW(reframed(Ramps().view(), larger, kCamera), InvalidInput);
}

}  // namespace
}  // namespace mimetic
