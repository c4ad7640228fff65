// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/retarget/seen_areas.hpp>
#include <mimetic/shared/error.hpp>

#include "../sanitized.hpp"

namespace mimetic {
namespace {

TEST(SeenAreas, AreasOfPolygons) {
    Points points(5, 3);
    points << 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 1, 3, 0;
    const Eigen::VectorXd areas = polygon_areas(points, {0, 4}, {0, 1, 2, 3, 3, 2, 4});
    EXPECT_NEAR(areas.sum(), 5, 1e-12);
    EXPECT_NEAR(areas[0], 1, 1e-12);
    EXPECT_NEAR(areas[4], 1. / 3, 1e-12);
    EXPECT_THROW(polygon_areas(points, {0}, {0, 1}), InvalidInput);
    EXPECT_THROW(polygon_areas(points, {0}, {0, 1, 5}), InvalidInput);
}

/// The six sides of a box about the origin, seen from outside: 8 points, 24 corners.
struct Box {
    Points points{8, 3};
    std::vector<int> starts, corners;

    explicit Box(double half) {
        for (int v = 0; v < 8; ++v) {
            points.row(v) = half * Eigen::RowVector3d(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1);
        }
        corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
        for (int face = 0; face < 6; ++face) {
            starts.push_back(4 * face);
        }
    }
};

TEST(SeenAreas, WhatLiesWithinCountsAHundredth) {
    const Box outer(1), inner(.5);
    Points points(16, 3);
    points << outer.points, inner.points;
    std::vector<int> starts = outer.starts, corners = outer.corners;
    for (const int start : inner.starts) {
        starts.push_back(24 + start);
    }
    for (const int corner : inner.corners) {
        corners.push_back(8 + corner);
    }
    const Eigen::VectorXd whole = polygon_areas(points, starts, corners),
                          seen = seen_areas(points, starts, corners);
    EXPECT_TRUE(seen.head(8).isApprox(whole.head(8), 1e-12));
    EXPECT_TRUE(seen.tail(8).isApprox(.01 * whole.tail(8), 1e-12));
    if (test::kIsSanitized) {
        return;  // the same once more, which takes them half a minute
    }
    // Without the lid, what is within is seen
    starts.erase(starts.begin() + 1);
    corners.erase(corners.begin() + 4, corners.begin() + 8);
    for (std::size_t face = 1; face < starts.size(); ++face) {
        starts[face] -= 4;
    }
    const Eigen::VectorXd open = seen_areas(points, starts, corners);
    EXPECT_NEAR(open[12] / whole[12], 1, 1e-12);
    EXPECT_NEAR(open[8] / whole[8], .01, 1e-12);
}

TEST(SeenAreas, AMeshWithoutPolygonsOrExtentHasNone) {
    EXPECT_EQ(seen_areas(Points::Zero(3, 3), {}, {}).norm(), 0);
    EXPECT_EQ(seen_areas(Points::Zero(3, 3), {0}, {0, 1, 2}).norm(), 0);
    EXPECT_THROW(seen_areas(Points::Zero(3, 3), {0}, {0, 1, 3}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
