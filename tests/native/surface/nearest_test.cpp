// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/nearest.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <random>

namespace mimetic {
namespace {

MatrixRows scattered(int count, int dimensions, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> step(0, 20);  // a coarse grid: many are equally near
    MatrixRows points(count, dimensions);
    for (double& value : points.reshaped()) {
        value = .1 * step(random);
    }
    return points;
}

TEST(NearestPoints, AreThoseThatASearchThroughAllFindsTheFirstOfEquals) {
    for (const int dimensions : {2, 3, 7}) {
        const MatrixRows cloud = scattered(500, dimensions, 1), points = scattered(300, dimensions, 2);
        const Eigen::VectorXi near = NearestPoints(cloud).find(points);
        for (Eigen::Index i = 0; i < points.rows(); ++i) {
            Eigen::Index expected = 0;
            double least = std::numeric_limits<double>::infinity();
            for (Eigen::Index k = 0; k < cloud.rows(); ++k) {
                double squared = 0;
                for (Eigen::Index d = 0; d < dimensions; ++d) {
                    squared += (cloud(k, d) - points(i, d)) * (cloud(k, d) - points(i, d));
                }
                if (squared < least) {
                    least = squared;
                    expected = k;
                }
            }
            EXPECT_EQ(near[i], expected);
        }
    }
}

TEST(NearestPoints, RefuseNothingAndWhatIsNotFinite) {
    EXPECT_THROW(NearestPoints(MatrixRows(0, 3)), InvalidInput);
    const NearestPoints one(MatrixRows::Zero(1, 3));
    EXPECT_THROW(one.find(MatrixRows::Zero(1, 2)), InvalidInput);
    EXPECT_THROW(one.find(MatrixRows::Constant(1, 3, std::nan(""))), InvalidInput);
}

TEST(SkinPlaces, ClosestPlaceIsInsideOnAnEdgeOrACorner) {
    Points vertices(3, 3);
    vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    Triangles triangle(1, 3);
    triangle << 0, 1, 2;
    Points points(3, 3);
    points << .2, .3, .5, .5, -1, 0, 3, -1, 0;
    const SkinPlaces places = nearest_places(points, vertices, triangle);
    Points expected(3, 3);
    expected << .2, .3, 0, .5, 0, 0, 1, 0, 0;
    EXPECT_TRUE(places.positions(vertices, 0).isApprox(expected, 1e-12));
    EXPECT_NEAR(places.gaps[0], .5, 1e-12);
    EXPECT_NEAR(places.positions(vertices, .25)(0, 2), .25, 1e-12);
    EXPECT_THROW(places.values(MatrixRows::Zero(2, 1)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
