// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mimetic/register/worn.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <vector>

namespace mimetic {
namespace {

constexpr int kRings = 40, kColumns = 60;

/// What is nearer to the skin than .03 lies on it.
Eigen::Matrix4d metres() {
    Eigen::Matrix4d scale = Eigen::Matrix4d::Identity() * (.008 / .03);
    scale(3, 3) = 1;
    return scale;
}

/// Points of a sphere's rings, from the pole at +z; all of them, or the upper ones alone.
Points ball(double radius, const Eigen::RowVector3d& centre, int num_rings = kRings) {
    Points points((num_rings + 1) * kColumns, 3);
    for (int ring = 0; ring <= num_rings; ++ring) {
        for (int column = 0; column < kColumns; ++column) {
            const double polar = std::numbers::pi * ring / kRings,
                         around = 2 * std::numbers::pi * column / kColumns;
            points.row(ring * kColumns + column) =
                centre + radius * Eigen::RowVector3d(std::sin(polar) * std::cos(around),
                                                     std::sin(polar) * std::sin(around), std::cos(polar));
        }
    }
    return points;
}

Triangles outward(int num_rings = kRings) {
    Triangles triangles(2 * num_rings * kColumns, 3);
    for (int ring = 0; ring < num_rings; ++ring) {
        for (int column = 0; column < kColumns; ++column) {
            const int a = ring * kColumns + column, b = ring * kColumns + (column + 1) % kColumns;
            const Eigen::Index row = 2 * (ring * kColumns + column);
            triangles.row(row) << a, a + kColumns, b + kColumns;
            triangles.row(row + 1) << a, b + kColumns, b;
        }
    }
    return triangles;
}

/// A ring about the head, as of glasses.
Points hoop(double radius, double height) {
    Points points(60, 3);
    for (int i = 0; i < 60; ++i) {
        const double around = 2 * std::numbers::pi * i / 60;
        points.row(i) << radius * std::cos(around), radius * std::sin(around), height;
    }
    return points;
}

const Eigen::RowVector3d kMiddle(0, 0, 0);

TEST(HeadViews, WhatLiesBeforeTheSkinIsWorn) {
    const HeadViews head(ball(1, kMiddle), outward(), metres());
    EXPECT_TRUE(head.wears(hoop(1.1, .3)));
    EXPECT_TRUE(head.wears(hoop(.4, 1.1)));
    EXPECT_TRUE(head.wears(hoop(.15, 1.05)));
}

TEST(HeadViews, WhatLiesOnTheSkinOrBehindItIsNot) {
    const HeadViews head(ball(1, kMiddle), outward(), metres());
    EXPECT_FALSE(head.wears(hoop(1.005, .05)));
    EXPECT_FALSE(head.wears(hoop(.8, .3)));
    EXPECT_FALSE(head.wears(ball(.15, {0, 0, .8})));
}

TEST(HeadViews, ABulgingEyeIsNot) {
    const HeadViews head(ball(1, kMiddle), outward(), metres());
    EXPECT_FALSE(head.wears(ball(.2, {0, 0, 1})));
    EXPECT_FALSE(head.wears(ball(.2, {0, 0, 1}, kRings / 2)));
}

TEST(HeadViews, WhatLiesBehindAMaskIsSeenFromItsInnerSide) {
    const HeadViews mask(ball(1, kMiddle, kRings / 2), outward(kRings / 2), metres());
    EXPECT_FALSE(mask.wears(hoop(.5, .5)));
    EXPECT_TRUE(mask.wears(hoop(.5, 1.05)));
}

TEST(HeadViews, NothingIsWornByNothing) {
    EXPECT_FALSE(HeadViews(Points(0, 3), Triangles(0, 3), metres()).wears(hoop(1, 0)));
    const HeadViews head(ball(1, kMiddle), outward(), metres());
    EXPECT_FALSE(head.wears(Points(0, 3)));
    EXPECT_FALSE(head.wears(Points::Constant(9, 3, std::numeric_limits<double>::quiet_NaN())));
}

TEST(HeadViews, ABrokenHeadIsRefused) {
    Triangles stray = outward();
    stray(0, 0) = 1'000'000;
    EXPECT_THROW(HeadViews(ball(1, kMiddle), outward(), Eigen::Matrix4d::Zero()), InvalidInput);
    EXPECT_THROW(HeadViews(ball(1, kMiddle), stray, metres()), InvalidInput);
    EXPECT_THROW(HeadViews(ball(std::numeric_limits<double>::infinity(), kMiddle), outward(), metres()),
                 InvalidInput);
}

}  // namespace
}  // namespace mimetic
