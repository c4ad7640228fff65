// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/raster/raster.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

const Quads kTwo = (Quads(2, 4) << 0, 1, 2, 3, 4, 5, 6, 7).finished();

Points2 squares(double first, double second) {
    Points2 pixels(8, 2);
    for (int k = 0; k < 2; ++k) {
        const double half = k == 0 ? first : second;
        pixels.middleRows(4 * k, 4) << 10 - half, 10 - half, 10 + half, 10 - half, 10 + half, 10 + half,
            10 - half, 10 + half;
    }
    return pixels;
}

TEST(RasterQuads, ShowsTheHigherAndItsPlaceInIt) {
    Eigen::VectorXd heights = Eigen::VectorXd::Zero(8);
    heights.tail(4).setConstant(1);
    const Points2 corners = squares(8.2, 3.2);
    const QuadRaster seen = raster_quads(corners, heights, kTwo, 20, 20);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            const int reach = std::max(std::abs(x - 10), std::abs(y - 10));
            const int face = seen.raster.face[seen.raster.index(x, y)];
            ASSERT_EQ(face, reach <= 3 ? 1 : (reach <= 8 ? 0 : -1)) << x << ", " << y;
            const auto weights = seen.weights.row(static_cast<Eigen::Index>(seen.raster.index(x, y)));
            if (face < 0) {
                EXPECT_TRUE(weights.isZero(0));
                continue;
            }
            const Eigen::RowVector2d place = weights.cast<double>() * corners.middleRows(4 * face, 4);
            EXPECT_NEAR(place.x(), x, 1e-5);
            EXPECT_NEAR(place.y(), y, 1e-5);
        }
    }
}

TEST(RasterQuads, TakesCornersFarOutsideThePicture) {
    const QuadRaster seen = raster_quads(squares(1e12, 1e9), Eigen::VectorXd::Zero(8), kTwo, 20, 20);
    EXPECT_EQ(seen.raster.face.front(), 0);
    EXPECT_EQ(seen.raster.face.back(), 0);
}

TEST(RasterQuads, RejectsBadIndicesAndNumbers) {
    Eigen::VectorXd heights = Eigen::VectorXd::Zero(8);
    EXPECT_THROW(raster_quads(squares(8, 3).topRows(4), heights.head(4), kTwo, 20, 20), InvalidInput);
    EXPECT_THROW(raster_quads(squares(8, 3), heights.head(4), kTwo, 20, 20), InvalidInput);
    heights[2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(raster_quads(squares(8, 3), heights, kTwo, 20, 20), InvalidInput);
}

/// A hilly sheet seen along y, each cell two triangles that face up.
TEST(RayCaster, AlongYFindsThePlaceOnASheet) {
    constexpr int kSide = 31;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> anywhere(0, 1), shift(-.2, .2);
    Points vertices(kSide * kSide, 3);
    for (int i = 0; i < vertices.rows(); ++i) {
        vertices.row(i) << (i % kSide + shift(random)) * 1e-3, anywhere(random) * 1e-3,
            (i / kSide + shift(random)) * 1e-3;
    }
    Triangles triangles(2 * (kSide - 1) * (kSide - 1), 3);
    for (int t = 0; t < triangles.rows() / 2; ++t) {
        const int corner = t / (kSide - 1) * kSide + t % (kSide - 1);
        triangles.row(2 * t) << corner, corner + kSide, corner + kSide + 1;
        triangles.row(2 * t + 1) << corner, corner + kSide + 1, corner + 1;
    }
    const RayCaster up(vertices, triangles, RayCaster::Facing::up);
    const RayCaster down(vertices, triangles, RayCaster::Facing::down);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector2d place =
            Eigen::Vector2d(.5 + 29 * anywhere(random), .5 + 29 * anywhere(random)) * 1e-3;
        const RayHit hit = up.at(place);
        ASSERT_GE(hit.triangle, 0);
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
            point += hit.weights[k] * vertices.row(triangles(hit.triangle, k)).transpose();
        }
        EXPECT_NEAR(hit.weights.sum(), 1, 1e-12);
        EXPECT_NEAR(point.x(), place.x(), 1e-12);
        EXPECT_NEAR(point.z(), place.y(), 1e-12);
        EXPECT_EQ(down.at(place).triangle, -1);
    }
    EXPECT_EQ(up.at({-1, 0}).triangle, -1);
}

TEST(RayCaster, OfTwoTrianglesBehindAPixelTheNearerIsMet) {
    const Camera camera{100, 100, 49.5, 39.5, 100, 80};
    Points vertices(6, 3);
    vertices << -1, 1, 3, 1, 1, 3, 0, -1, 3, -1, 1, 2, 1, 1, 2, 0, -1, 2;
    const Triangles triangles = (Triangles(2, 3) << 0, 1, 2, 3, 4, 5).finished();
    const Points2 pixels = (Points2(2, 2) << 49.5, 39.5, 0, 0).finished();
    const RayHits hits = cast_rays(camera, vertices, triangles, pixels);
    EXPECT_EQ(hits.triangle[0], 1);
    EXPECT_TRUE(hits.weights.row(0).isApprox(Eigen::RowVector3d(.25, .25, .5), 1e-12));
    EXPECT_EQ(hits.triangle[1], -1);
    const RayCaster empty(Points(0, 3), Triangles(0, 3), RayCaster::Facing::up);
    EXPECT_EQ(empty.at({0, 0}).triangle, -1);
}

}  // namespace
}  // namespace mimetic
