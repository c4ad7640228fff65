// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/solve/bounded_step.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace mimetic {
namespace {

TEST(BoundedStep, MeetsTheOptimalityConditions) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    constexpr int kSize = 20;
    for (int trial = 0; trial < 50; ++trial) {
        const Eigen::MatrixXd root =
            Eigen::MatrixXd::NullaryExpr(kSize, kSize, [&] { return normal(random); });
        const Eigen::MatrixXd information =
            root * root.transpose() + .1 * Eigen::MatrixXd::Identity(kSize, kSize);
        const Eigen::VectorXd gradient =
            Eigen::VectorXd::NullaryExpr(kSize, [&] { return 9 * normal(random); });
        Eigen::VectorXd lower = Eigen::VectorXd::Constant(kSize, -.2),
                        upper = Eigen::VectorXd::Constant(kSize, .5);
        lower.head<6>().setConstant(-std::numeric_limits<double>::infinity());
        upper.head<6>().setConstant(std::numeric_limits<double>::infinity());
        lower[8] = upper[8] = upper[9] = 0;
        const Eigen::VectorXd step = bounded_step(information, gradient, lower, upper);
        const Eigen::VectorXd pull = gradient - information * step;
        for (int i = 0; i < kSize; ++i) {
            EXPECT_GE(step[i], lower[i]);
            EXPECT_LE(step[i], upper[i]);
            if (step[i] > lower[i]) {
                EXPECT_GT(pull[i], -1e-6);
            }
            if (step[i] < upper[i]) {
                EXPECT_LT(pull[i], 1e-6);
            }
        }
    }
}

}  // namespace
}  // namespace mimetic
