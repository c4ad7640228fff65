// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/fit/follow.hpp>
#include <mimetic/fit/picture.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

/// RGB of a smooth random pattern, shifted to the right by some pixels.
std::vector<std::uint8_t> pattern(int width, int height, double shift) {
    std::vector<std::uint8_t> image;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double u = x - shift;
            const double value = 128 + 50 * std::sin(.31 * u + .11 * y) + 45 * std::sin(.13 * u - .29 * y);
            for (int channel = 0; channel < 3; ++channel) {
                image.push_back(static_cast<std::uint8_t>(value));
            }
        }
    }
    return image;
}

ColorView view_of(const std::vector<std::uint8_t>& image, int width, int height) {
    return {image.data(), height, width, std::ptrdiff_t{3} * width};
}

TEST(FacingEdges, AreThoseOfQuadsThatFaceTheCameraEachOnce) {
    Points vertices(6, 3);
    vertices << 0, 0, 1, 0, .1, 1, .1, .1, 1, .1, 0, 1, .2, .1, 1, .2, 0, 1;
    Quads quads(2, 4);
    quads << 0, 1, 2, 3, 3, 2, 4, 5;
    const Edges both = facing_edges(vertices, quads, .1);
    ASSERT_EQ(both.rows(), 7);  // one is shared
    EXPECT_EQ(both(0, 0), 0);
    EXPECT_EQ(both(0, 1), 1);
    quads.row(1) << 5, 4, 2, 3;  // turned over
    EXPECT_EQ(facing_edges(vertices, quads, .1).rows(), 4);
    quads(0, 0) = 6;
    EXPECT_THROW(facing_edges(vertices, quads, .1), InvalidInput);
}

/// Two squares of a metre side by side with a slit between them, the second higher; and one turned away.
class CanonicalPixelsTest : public testing::Test {
protected:
    CanonicalPixelsTest() {
        vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,      //
            1.001, 0, .1, 2, 0, .1, 2, 1, .1, 1.001, 1, .1;  //
        quads << 0, 1, 2, 3, 4, 5, 6, 7, 3, 2, 1, 0;
    }

    Points vertices = Points(8, 3);
    Quads quads = Quads(3, 4);
    std::vector<bool> is_hidden = std::vector<bool>(8, false);
};

TEST_F(CanonicalPixelsTest, ShowWhatFacesTheViewerWithoutTheSlit) {
    constexpr int kSize = 64;
    const CanonicalPixels seen = canonical_pixels(vertices, quads, is_hidden, kSize, .1);
    EXPECT_LT((seen.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-6);
    const double pixel_size = 2 * 1.04 / kSize;  // metres
    std::vector<int> in_row(kSize, 0);
    for (Eigen::Index k = 0; k < seen.pixel.size(); ++k) {
        const int row = seen.pixel[k] / kSize, column = seen.pixel[k] % kSize;
        ++in_row[static_cast<std::size_t>(row)];
        Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
        for (int c = 0; c < 4; ++c) {
            place += seen.weights(k, c) * vertices.row(seen.corners(k, c));
        }
        EXPECT_NEAR(place.x(), 1 + (column - (kSize - 1) / 2.) * pixel_size, .67 * pixel_size);
        EXPECT_NEAR(place.y(), .5 - (row - (kSize - 1) / 2.) * pixel_size, .67 * pixel_size);
    }
    EXPECT_EQ(in_row[kSize / 2], in_row[kSize / 2 - 3]);
    EXPECT_NEAR(in_row[kSize / 2], kSize / 1.04, 2);  // a pixel on the slit has its neighbour's
}

TEST_F(CanonicalPixelsTest, LeaveOutWhatIsHiddenWhole) {
    is_hidden[0] = true;
    EXPECT_EQ(canonical_pixels(vertices, quads, is_hidden, 32, .1).corners.minCoeff(), 0);
    std::fill_n(is_hidden.begin(), 4, true);
    EXPECT_EQ(canonical_pixels(vertices, quads, is_hidden, 32, .1).corners.minCoeff(), 4);
    is_hidden.assign(8, true);
    EXPECT_THROW(canonical_pixels(vertices, quads, is_hidden, 32, .1), InvalidInput);
    is_hidden.resize(7);
    EXPECT_THROW(canonical_pixels(vertices, quads, is_hidden, 32, .1), InvalidInput);
    is_hidden.assign(8, false);
    EXPECT_THROW(canonical_pixels(vertices, quads, is_hidden, 1 << 20, .1), InvalidInput);
    quads(0, 0) = 8;
    EXPECT_THROW(canonical_pixels(vertices, quads, is_hidden, 32, .1), InvalidInput);
}

TEST(SeenColours, AreThoseOfThePictureWhereTheSurfaceFacesTheCamera) {
    const Camera camera{100, 100, 15.5, 15.5, 32, 32};
    const auto image = pattern(32, 32, 0);
    Points vertices(4, 3);
    vertices << -.1, -.1, 1, -.1, .1, 1, .1, .1, 1, .1, -.1, 1;
    CanonicalPixels pixels{Eigen::Vector3i(0, 1, 2), Quads(3, 4), Rows<double, 4>(3, 4)};
    pixels.corners << 0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2, 3;
    pixels.weights << .25, .25, .25, .25, .25, .25, .25, .25, 3, 0, -2, 0;  // the last far outside
    const SeenColours seen = seen_colours(view_of(image, 32, 32), camera, vertices, pixels, .1);
    EXPECT_EQ(seen.is_seen, (std::vector<bool>{true, false, false}));
    const auto at = [&](int y, int x) { return image[static_cast<std::size_t>(3 * (32 * y + x))]; };
    const double mean = (at(15, 15) + at(15, 16) + at(16, 15) + at(16, 16)) / 4.;
    EXPECT_NEAR(seen.colours(0, 1), mean, .51);
    EXPECT_EQ(seen.colours.row(1).sum(), 0);
}

TEST(MirrorCorrelation, IsOneOfASymmetricPictureWhateverTheLight) {
    constexpr int kSide = 64;
    std::mt19937 random(2);
    std::vector<std::uint8_t> image(3 * kSide * kSide), lit, other;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide / 2; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                const auto level = static_cast<std::uint8_t>(60 + random() % 100);
                image[static_cast<std::size_t>(3 * (y * kSide + x) + channel)] = level;
                image[static_cast<std::size_t>(3 * (y * kSide + kSide - 1 - x) + channel)] = level;
            }
        }
    }
    const std::vector<bool> all(kSide * kSide, true);
    EXPECT_NEAR(mirror_correlation(view_of(image, kSide, kSide), all), 1, 1e-6);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double share = double((i / 3) % kSide) / kSide;
        lit.push_back(static_cast<std::uint8_t>(image[i] * (.5 + .8 * share)));
        other.push_back(static_cast<std::uint8_t>(60 + random() % 100));
    }
    EXPECT_GT(mirror_correlation(view_of(lit, kSide, kSide), all), .9);
    EXPECT_LT(mirror_correlation(view_of(other, kSide, kSide), all), .3);
    EXPECT_THROW(mirror_correlation(view_of(image, kSide, kSide), std::vector<bool>(3)), InvalidInput);
}

TEST(FollowPoints, TellHowFarTheFaceMovedThoughThePosesErr) {
    const Camera camera{300, 300, 79.5, 59.5, 160, 120};
    const auto before = pattern(160, 120, 0), after = pattern(160, 120, 4.5);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    FollowedPoints followed{{}, Points(25, 3), Points(25, 3)};
    for (int i = 0; i < 25; ++i) {
        followed.points.push_back(100 + i);
        followed.places.row(i) << .2 * (i % 5 - 2), .15 * (i / 5 - 2), 2;
        followed.normals.row(i) << 0, 0, -1;
    }
    followed.normals.row(3) << 1, 0, 0;  // turned away
    Eigen::Isometry3d there = pose;
    there.translation().x() = 3.5 / 300 * 2;  // a pixel short
    const auto motion =
        follow_points(view_of(before, 160, 120), view_of(after, 160, 120), camera, pose, there, followed, 60);
    ASSERT_GE(motion.size(), 15u);
    for (const PointMotion& one : motion) {
        EXPECT_NE(one.point, 103);
        EXPECT_NEAR(one.shift.x(), 4.5, .5);
        EXPECT_NEAR(one.shift.y(), 0, .5);
        EXPECT_GE(one.sigma_px, .036 * 60);
    }
    followed.points.resize(20);
    EXPECT_THROW(
        follow_points(view_of(before, 160, 120), view_of(after, 160, 120), camera, pose, there, followed, 60),
        InvalidInput);
}

}  // namespace
}  // namespace mimetic
