// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mimetic/raster/depth.hpp>
#include <mimetic/raster/overlay.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

const Camera kCamera{100, 100, 49.5, 39.5, 100, 80};

/// A square that faces the camera, counter-clockwise seen from it (its y points down).
Points square(double half, double x, double z) {
    Points points(4, 3);
    points << x - half, half, z, x + half, half, z, x + half, -half, z, x - half, -half, z;
    return points;
}

Points stack(const Points& a, const Points& b) {
    Points both(a.rows() + b.rows(), 3);
    both << a, b;
    return both;
}

const Quads kOne = (Quads(1, 4) << 0, 1, 2, 3).finished();
const Quads kTwo = (Quads(2, 4) << 0, 1, 2, 3, 4, 5, 6, 7).finished();

struct Black {
    std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(100 * 80 * 3, 0);
    ColorView view() const { return {pixels.data(), 80, 100, 300}; }
};

/// Number of pixels above the gauge's strip that the overlay lit.
int count_lit(const ColorImage& image, int first_x, int last_x) {
    int count = 0;
    for (int y = 0; y < image.rows - image.rows / 3; ++y) {
        for (int x = first_x; x < last_x; ++x) {
            count += image.pixels[static_cast<std::size_t>(3 * (y * image.cols + x) + 1)] > 20;
        }
    }
    return count;
}

TEST(Depth, OfASlantedSquareIsExactAtEveryPixel) {
    Points points = square(0.2, 0, 1);
    points.col(2) += 0.8 * points.col(0);  // the plane z = 1 + 0.8 x
    const DepthMap map = render_depth(kCamera, points, kOne);
    int num_covered = 0;
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 100; ++x) {
            const float depth = map.depth[static_cast<std::size_t>(y * 100 + x)];
            if (std::isfinite(depth)) {
                EXPECT_NEAR(depth, 1 / (1 - 0.8 * (x - 49.5) / 100), 1e-5);
                ++num_covered;
            }
        }
    }
    EXPECT_GT(num_covered, 1400);
    EXPECT_LT(num_covered, 1900);
}

TEST(Depth, NearerSurfacesHideFartherPoints) {
    const DepthMap map = render_depth(kCamera, stack(square(0.1, 0, 1), square(0.5, 0, 2)), kTwo);
    EXPECT_FALSE(map.shows(kCamera, {0, 0, 2}, 1e-3));
    EXPECT_TRUE(map.shows(kCamera, {0, 0, 1}, 1e-3));
    EXPECT_TRUE(map.shows(kCamera, {0.4, 0, 2}, 1e-3));
    EXPECT_FALSE(map.shows(kCamera, {9, 0, 2}, 1e-3)) << "outside the image";
    EXPECT_FALSE(map.shows(kCamera, {0, 0, -1}, 1e-3)) << "behind the camera";
}

TEST(Depth, LeavesOutFacesBehindTheCamera) {
    const DepthMap map = render_depth(kCamera, square(0.2, 0, -1), kOne);
    for (const float depth : map.depth) {
        EXPECT_TRUE(std::isinf(depth));
    }
}

TEST(Depth, RejectsBadIndicesAndNumbers) {
    EXPECT_THROW(render_depth(kCamera, square(0.2, 0, 1), kTwo), InvalidInput);
    Points points = square(0.2, 0, 1);
    points(2, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(render_depth(kCamera, points, kOne), InvalidInput);
}

TEST(Overlay, DrawsFacesThatFaceTheCameraOnly) {
    const OverlayPainter painter(kCamera, 4, kOne, {});
    const Points front = square(0.2, 0, 1);
    EXPECT_GT(count_lit(painter.paint(Black().view(), front, 1, 1), 0, 100), 60);
    const Points back = front.colwise().reverse();
    EXPECT_EQ(count_lit(painter.paint(Black().view(), back, 1, 1), 0, 100), 0);
}

TEST(Overlay, HidesLinesBehindTheSurface) {
    const OverlayPainter painter(kCamera, 8, kTwo, {});
    const Points covered = stack(square(0.25, 0, 1), square(0.1, 0, 2));
    const Points alone = stack(square(0.25, 0, 1), square(0.1, 0, 1));
    const int inside_covered = count_lit(painter.paint(Black().view(), covered, 1, 1), 35, 65);
    const int inside_alone = count_lit(painter.paint(Black().view(), alone, 1, 1), 35, 65);
    EXPECT_LT(inside_covered, inside_alone);
}

TEST(Overlay, MarksLandmarksAndEnlarges) {
    OverlayOptions options;
    options.scale = 3;
    const OverlayPainter painter(kCamera, 4, kOne, {0}, options);
    const ColorImage image = painter.paint(Black().view(), square(0.1, 0, 1), 0.9, 12);
    ASSERT_EQ(image.cols, 300);
    ASSERT_EQ(image.rows, 240);
    // vertex 0 projects to (39.5, 49.5), the middle of the enlarged pixels (119, 149) and (120, 149)
    const std::uint8_t* pixel = image.pixels.data() + 3 * (149 * 300 + 119);
    EXPECT_GT(pixel[0], 200);
    EXPECT_LT(pixel[2], 130);
}

TEST(Overlay, SurvivesAHeadThatIsFarOutOfThePicture) {
    const OverlayPainter painter(kCamera, 4, kOne, {0, 1, 2, 3});
    EXPECT_EQ(count_lit(painter.paint(Black().view(), square(0.1, 1e9, 1), 0, 1), 0, 100), 0);
    EXPECT_NO_THROW(painter.paint(Black().view(), square(1e6, 0, 1e-2), 0, 1));
}

TEST(Overlay, RejectsWhatDoesNotFit) {
    EXPECT_THROW(OverlayPainter(kCamera, 3, kOne, {}), InvalidInput);
    EXPECT_THROW(OverlayPainter(kCamera, 4, kOne, {4}), InvalidInput);
    const OverlayPainter painter(kCamera, 4, kOne, {});
    EXPECT_THROW(painter.paint(Black().view(), square(1, 0, 1).topRows(3), 1, 1), InvalidInput);
    const std::vector<std::uint8_t> small(20 * 20 * 3);
    EXPECT_THROW(painter.paint({small.data(), 20, 20, 60}, square(1, 0, 1), 1, 1), InvalidInput);
}

}  // namespace
}  // namespace mimetic
