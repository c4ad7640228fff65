// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/solve.hpp>

namespace mimetic {
namespace {

/// Two muscles that move the same point the same way.
FaceMotion collinear(double correlation) {
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Zero(2, 3);
    motion.modes.col(0).setOnes();
    motion.num_muscles = 2;
    motion.lower = Eigen::VectorXd::Zero(2);
    motion.upper = Eigen::VectorXd::Ones(2);
    motion.prior_std = Eigen::VectorXd::Constant(2, .3);
    if (correlation != 0) {
        motion.correlation = Eigen::MatrixXd::Constant(2, 2, correlation);
        motion.correlation.diagonal().setOnes();
    }
    return motion;
}

/// Values in the middle of a clip whose frames measure the muscles' sum well, and that the first is more
/// active by a little that noise may have made.
Eigen::VectorXd read(const FaceMotion& motion) {
    Eigen::Matrix2d information;
    information << 1005, 995, 995, 1005;
    std::vector<FrameEstimate> estimates(40);
    for (FrameEstimate& estimate : estimates) {
        estimate.values = Eigen::VectorXd::Zero(2);
        estimate.information = 1000 * Eigen::MatrixXd::Identity(8, 8);
        estimate.information.bottomRightCorner<2, 2>() = information;
        estimate.covariance = estimate.information.inverse();
        estimate.gradient = Eigen::VectorXd::Zero(8);
        estimate.gradient.tail(2) = information * Eigen::Vector2d(.5, .1);
    }
    return smooth(estimates, motion)[20].values;
}

TEST(CoContraction, SharesWhatEitherOfTwoMusclesMayHaveDone) {
    const Eigen::VectorXd apart = read(collinear(0)), together = read(collinear(.6));
    EXPECT_LT(apart[1], .05);
    EXPECT_GT(together[1], .15);
    EXPECT_NEAR(apart.sum(), together.sum(), .05);
}

TEST(CoContraction, RefusesWhatIsNoCorrelation) {
    FaceMotion motion = collinear(.6);
    motion.correlation(0, 1) = .5;
    EXPECT_THROW(read(motion), InvalidInput);
    EXPECT_THROW(read(collinear(1.5)), InvalidInput);
    motion.correlation = Eigen::MatrixXd::Identity(3, 3);
    EXPECT_THROW(read(motion), InvalidInput);
}

}  // namespace
}  // namespace mimetic
