// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/analyse/curve_edits.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

Eigen::VectorXd frames_at(double rate, double seconds) {
    const auto count = static_cast<Eigen::Index>(seconds * rate) + 1;
    return Eigen::VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) / rate * 25);
}

TEST(SmoothCurve, KeepsAParabolaToItsEnds) {
    Eigen::VectorXd frames(7);
    frames << 1, 2, 3.5, 4, 7, 8, 9;
    const Eigen::VectorXd values = 2 + .3 * frames.array() - .02 * frames.array().square();
    for (const double width : {0., .2, 1., 3., 50.}) {
        const SmoothedCurve curve = smooth_curve(frames, values, frames, width);
        EXPECT_LT((curve.values - values).cwiseAbs().maxCoeff(), 1e-9) << width;
        EXPECT_LT((curve.slopes.array() - .3 + .04 * frames.array()).abs().maxCoeff(), 1e-8) << width;
    }
}

TEST(SmoothCurve, TakesNoiseAwayAndLeavesTheMotion) {
    const Eigen::VectorXd frames = frames_at(25, 40);
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, .05);
    const Eigen::VectorXd motion = (frames.array() / 15).sin();
    Eigen::VectorXd noise(frames.size());
    for (double& one : noise) {
        one = normal(random);
    }
    const Eigen::VectorXd seen = motion + noise;
    const SmoothedCurve curve = smooth_curve(frames, seen, frames, 3);
    EXPECT_LT((curve.values - motion).norm(), .5 * noise.norm());
    EXPECT_LT((smooth_curve(frames, motion, frames, 3).values - motion).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(SmoothCurve, DoesNotDependOnTheRateOfItsSamples) {
    const auto values_at = [](const Eigen::VectorXd& frames) {
        return Eigen::VectorXd((frames.array() / 7).sin() + .2 * (frames.array() / 1.5).cos());
    };
    const Eigen::VectorXd slow = frames_at(24, 8);
    const Eigen::VectorXd fast = frames_at(120, 8);
    const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(50, 20, 170);
    const SmoothedCurve few = smooth_curve(slow, values_at(slow), at, 4);
    const SmoothedCurve many = smooth_curve(fast, values_at(fast), at, 4);
    EXPECT_LT((few.values - many.values).cwiseAbs().maxCoeff(), 2e-3);
    EXPECT_LT((few.slopes - many.slopes).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(SmoothCurve, OneAndTwoFramesAreLeftAsTheyAre) {
    const Eigen::VectorXd one = Eigen::VectorXd::Constant(1, 5.);
    EXPECT_EQ(smooth_curve(one, one, one, 3).values[0], 5);
    const Eigen::VectorXd two = Eigen::Vector2d(1, 3);
    EXPECT_NEAR(smooth_curve(two, two, two, 3).slopes[0], 1, 1e-9);
}

TEST(SmoothCurve, RefusesWhatIsNoCurve) {
    const Eigen::VectorXd falling = Eigen::Vector2d(2, 1);
    EXPECT_THROW(smooth_curve(falling, falling, falling, 1), InvalidInput);
    const Eigen::VectorXd rising = Eigen::Vector2d(1, 2);
    EXPECT_THROW(smooth_curve(rising, rising, rising, -1), InvalidInput);
    EXPECT_THROW(smooth_curve(rising, rising.head(1), rising, 1), InvalidInput);
    EXPECT_THROW(smooth_curve(rising, Eigen::Vector2d(1, NAN), rising, 1), InvalidInput);
}

TEST(RetimedFrames, StretchesWhatLiesBetweenAndMovesWhatComesAfter) {
    Eigen::VectorXd frames(6);
    frames << 0, 10, 12, 15, 20, 30;
    Eigen::VectorXd slower(6);
    slower << 0, 10, 14, 20, 30, 40;
    EXPECT_LT((retimed_frames(frames, 10, 20, 2) - slower).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((retimed_frames(slower, 10, 30, .5) - frames).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_THROW(retimed_frames(frames, 10, 20, 0), InvalidInput);
    EXPECT_THROW(retimed_frames(frames, 20, 10, 1), InvalidInput);
}

}  // namespace
}  // namespace mimetic
