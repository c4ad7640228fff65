// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace mimetic
