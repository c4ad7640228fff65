// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/surface/centre_of_motion.hpp>

namespace mimetic {
namespace {

TEST(CentreOfMotion, WeighsPointsByTheSquaresOfTheirDisplacements) {
    MatrixRows points(3, 3), field = MatrixRows::Zero(3, 3);
    points << 0, 0, 0, 1, 0, 0, 0, 5, 0;
    field(0, 2) = 1;
    field(1, 0) = -2;
    EXPECT_TRUE(centre_of_motion(points, field).isApprox(Eigen::RowVector3d(.8, 0, 0)));
}

TEST(CentreOfMotion, IsThePointsMiddleWhereNothingMoves) {
    MatrixRows points(2, 3);
    points << 1, 2, 3, 3, 2, 1;
    EXPECT_TRUE(centre_of_motion(points, MatrixRows::Zero(2, 3)).isApprox(Eigen::RowVector3d(2, 2, 2)));
    EXPECT_THROW(centre_of_motion(points, MatrixRows::Zero(3, 3)), InvalidInput);
    EXPECT_THROW(centre_of_motion(MatrixRows(0, 3), MatrixRows(0, 3)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
