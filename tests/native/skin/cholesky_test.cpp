// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/skin/cholesky.hpp"

#include <gtest/gtest.h>

namespace mimetic {
namespace {

/// Springs between the points of a grid, each held by `attachment`; whole 3 x 3 blocks.
Eigen::SparseMatrix<double> grid_of_springs(int side, double attachment) {
    Eigen::Matrix3d spring;
    spring << 2, .3, .1, .3, 3, .2, .1, .2, 1;
    Eigen::MatrixXd dense = attachment * Eigen::MatrixXd::Identity(3 * side * side, 3 * side * side);
    const auto connect = [&](int a, int b) {
        for (const auto& [row, column, sign] : {std::tuple{a, a, 1}, {b, b, 1}, {a, b, -1}, {b, a, -1}}) {
            dense.block<3, 3>(3 * row, 3 * column) += sign * spring;
        }
    };
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            if (x + 1 < side) {
                connect(y * side + x, y * side + x + 1);
            }
            if (y + 1 < side) {
                connect(y * side + x, (y + 1) * side + x);
            }
        }
    }
    return dense.sparseView();
}

TEST(BlockCholesky, SolvesAsTheOneThatOrdersUnknowns) {
    BlockCholesky by_points;
    Cholesky by_unknowns;
    for (const int side : {1, 4, 12}) {  // one factor for matrices of other sizes in turn
        const Eigen::SparseMatrix<double> matrix = grid_of_springs(side, .5);
        by_points.compute_blocks(matrix);
        by_unknowns.compute(matrix);
        ASSERT_EQ(by_points.info(), Eigen::Success);
        const Eigen::MatrixXd loads = Eigen::MatrixXd::Random(matrix.cols(), 2);
        const Eigen::MatrixXd solved = by_points.solve(loads);
        EXPECT_LT((matrix * solved - loads).cwiseAbs().maxCoeff(), 1e-12);
        EXPECT_LT((solved - by_unknowns.solve(loads)).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
    BlockCholesky factor;
    factor.compute_blocks(grid_of_springs(4, -1));
    EXPECT_NE(factor.info(), Eigen::Success);
    factor.compute_blocks(grid_of_springs(4, 1));
    EXPECT_EQ(factor.info(), Eigen::Success);
}

}  // namespace
}  // namespace mimetic
