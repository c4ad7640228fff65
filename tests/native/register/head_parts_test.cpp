// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <mimetic/register/head_parts.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Turned, half as large, mirrored if asked for, and moved.
Eigen::Matrix4d frame(bool mirrored) {
    Eigen::Affine3d place = Eigen::Translation3d(3, 2, 1) *
                            Eigen::AngleAxisd(.7, Eigen::Vector3d(1, 2, 3).normalized()) *
                            Eigen::Scaling(mirrored ? -.5 : .5, .5, .5);
    return place.matrix();
}

const Points kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(HeadParts, WhatMovesInTheHeadMovesAsFarInThePartsOwnFrame) {
    for (const bool mirrored : {false, true}) {
        const Eigen::Matrix4d place = frame(mirrored);
        const Points own = Points::Random(4, 3);
        const Points moved = placed_points(kCorners + own, place) - placed_points(kCorners, place);
        EXPECT_TRUE(moved_in_part(moved, place).isApprox(own, 1e-12));
        EXPECT_EQ(is_mirror(place), mirrored);
        EXPECT_TRUE(placed_points(kCorners, place).row(0).isApprox(Eigen::RowVector3d(3, 2, 1)));
    }
}

TEST(HeadParts, AreSmallAndInsideOfTheHeadsBox) {
    const Points head = 10 * kCorners;
    const auto at = [](double place) { return Points(kCorners.array() + place); };
    EXPECT_TRUE(lies_in_box(head, at(1)));
    EXPECT_TRUE(lies_in_box(head, at(9.1)));  // hardly outside
    EXPECT_FALSE(lies_in_box(head, at(9.5)));
    EXPECT_FALSE(lies_in_box(head, at(-.5)));
    EXPECT_FALSE(lies_in_box(head, 6 * kCorners));
    EXPECT_FALSE(lies_in_box(head, Points(0, 3)));
    EXPECT_FALSE(lies_in_box(head, at(std::numeric_limits<double>::quiet_NaN())));
}

TEST(HeadParts, APartThatIsScaledToNothingIsRefused) {
    Eigen::Matrix4d flat = frame(false);
    flat.row(1).setZero();
    EXPECT_THROW(placed_points(kCorners, flat), InvalidInput);
    EXPECT_THROW(moved_in_part(kCorners, flat), InvalidInput);
}

}  // namespace
}  // namespace mimetic
