// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <mimetic/solve.hpp>
#include <random>

namespace mimetic {
namespace {

TEST(Smooth, CovarianceOfALongClipStaysBelowThatOfOneFrame) {
    constexpr int kNumValues = 30;
    constexpr int kSize = 6 + kNumValues;
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Zero(kNumValues, 3);
    motion.num_muscles = kNumValues;
    motion.lower = Eigen::VectorXd::Zero(kNumValues);
    motion.upper = Eigen::VectorXd::Ones(kNumValues);
    motion.prior_std = Eigen::VectorXd::Constant(kNumValues, 0.3);

    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    std::vector<FrameEstimate> estimates(150);
    for (FrameEstimate& estimate : estimates) {
        Eigen::MatrixXd slopes = Eigen::MatrixXd::NullaryExpr(50, kSize, [&] { return normal(random); });
        slopes.leftCols<6>() *= 500;
        estimate.values = Eigen::VectorXd::Constant(kNumValues, 0.3);
        estimate.information = slopes.transpose() * slopes;
        estimate.covariance = estimate.information.inverse();
        estimate.gradient = Eigen::VectorXd::Zero(kSize);
        estimate.model_covariance = Eigen::MatrixXd::Zero(kSize, kSize);
        estimate.held = true;
    }
    const std::vector<FrameEstimate> smoothed = smooth(estimates, motion);
    ASSERT_EQ(smoothed.size(), estimates.size());
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        for (int i = 0; i < kSize; ++i) {
            EXPECT_GT(smoothed[t].covariance(i, i), 0) << "frame " << t;
            EXPECT_LT(smoothed[t].covariance(i, i), estimates[t].covariance(i, i)) << "frame " << t;
        }
    }
}

}  // namespace
}  // namespace mimetic
