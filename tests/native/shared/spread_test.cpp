// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/spread.hpp>

namespace mimetic {
namespace {

MatrixRows on_a_line(std::initializer_list<double> places) {
    MatrixRows rows(static_cast<Eigen::Index>(places.size()), 1);
    Eigen::Index i = 0;
    for (const double place : places) {
        rows(i++, 0) = place;
    }
    return rows;
}

TEST(SpreadRows, TheFarthestFromAllChosenIsNext) {
    const MatrixRows rows = on_a_line({0, 1, 4, 9, 10});
    EXPECT_EQ(spread_rows(rows, {0}, std::vector<bool>(5, true), 4), (std::vector<int>{0, 4, 2, 1}));
}

TEST(SpreadRows, RowsThatAreNotAllowedAreLeftOutUnlessFirst) {
    const MatrixRows rows = on_a_line({0, 1, 4, 9, 10});
    EXPECT_EQ(spread_rows(rows, {0}, {false, true, true, true, false}, 3), (std::vector<int>{0, 3, 2}));
}

TEST(SpreadRows, EndsWhereNothingIsFarEnoughOrLeft) {
    const MatrixRows rows = on_a_line({0, 1, 4, 10, 10});
    EXPECT_EQ(spread_rows(rows, {0}, std::vector<bool>(5, true), 5, 3), (std::vector<int>{0, 3, 2}));
    EXPECT_EQ(spread_rows(rows, {0}, std::vector<bool>(5, true), 9), (std::vector<int>{0, 3, 2, 1}));
}

TEST(SpreadRows, RefusesARowThatIsNotThere) {
    const MatrixRows rows = on_a_line({0, 1});
    EXPECT_THROW(spread_rows(rows, {2}, std::vector<bool>(2, true), 2), InvalidInput);
    EXPECT_THROW(spread_rows(rows, {}, std::vector<bool>(2, true), 2), InvalidInput);
    EXPECT_THROW(spread_rows(rows, {0}, std::vector<bool>(3, true), 2), InvalidInput);
}

TEST(DrawnApart, CrowdedPointsGiveWayAndMirroredOnesStayMirrored) {
    Points points(7, 3);
    points << .010, 1, 0, .011, 2, .001, .012, 3, -.001, -.010, 1, 0, -.011, 2, .001, -.012, 3, -.001, .5, 4,
        .5;
    const Points apart = drawn_apart(points, .008);
    for (Eigen::Index i = 0; i < apart.rows(); ++i) {
        for (Eigen::Index j = i + 1; j < apart.rows(); ++j) {
            EXPECT_GT(std::hypot(apart(i, 0) - apart(j, 0), apart(i, 2) - apart(j, 2)), .0079)
                << i << " " << j;
        }
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
        EXPECT_NEAR(apart(i, 0), -apart(i + 3, 0), 1e-12);
        EXPECT_NEAR(apart(i, 2), apart(i + 3, 2), 1e-12);
    }
    EXPECT_EQ(apart.col(1), points.col(1));
    EXPECT_EQ(apart.row(6), points.row(6));
    EXPECT_LT((apart - points).rowwise().norm().maxCoeff(), .012);
}

TEST(DrawnApart, PointsAtOnePlaceParted) {
    const Points apart = drawn_apart(Points::Zero(2, 3), .01);
    EXPECT_NEAR(apart(0, 2) - apart(1, 2), .01, 1e-4);
    EXPECT_THROW(drawn_apart(Points::Zero(2, 3), -1), InvalidInput);
}

}  // namespace
}  // namespace mimetic
