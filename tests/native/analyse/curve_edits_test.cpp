// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
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

/// A cubic between two keys, a share of the way.
double cubic_at(const SmoothedCurve& curve, const Eigen::VectorXd& keys, Eigen::Index i, double share) {
    const double span = keys[i + 1] - keys[i], rest = 1 - share;
    return curve.values[i] * rest * rest * (1 + 2 * share) +
           curve.values[i + 1] * share * share * (3 - 2 * share) +
           span * share * rest * (curve.slopes[i] * rest - curve.slopes[i + 1] * share);
}

double worst_between(const SmoothedCurve& curve, const Eigen::VectorXd& keys, const Eigen::VectorXd& frames,
                     const Eigen::VectorXd& values, double width) {
    double worst = 0;
    for (Eigen::Index i = 0; i + 1 < keys.size(); ++i) {
        for (const double share : {.1, .3, .5, .7, .9}) {
            const Eigen::VectorXd at =
                Eigen::VectorXd::Constant(1, keys[i] + share * (keys[i + 1] - keys[i]));
            const double wanted = smooth_curve(frames, values, at, width).values[0];
            worst = std::max(worst, std::abs(cubic_at(curve, keys, i, share) - wanted));
        }
    }
    return worst;
}

TEST(SmoothKeys, TheCubicsBetweenFewKeysFollowTheSmoothedCurve) {
    const Eigen::VectorXd frames = Eigen::VectorXd::LinSpaced(241, 0, 60);
    const Eigen::VectorXd values = (.06 * frames.array()).min(.54 + .006 * frames.array());
    const Eigen::VectorXd keys = Eigen::Vector3d(0, 10, 60);
    const SmoothedCurve curve = smooth_keys(frames, values, keys, 2);
    EXPECT_LT((curve.values - smooth_curve(frames, values, keys, 2).values).norm(), 1e-12);
    EXPECT_LT(worst_between(curve, keys, frames, values, 2), .04);
    EXPECT_GT(worst_between(smooth_curve(frames, values, keys, 2), keys, frames, values, 2), .1);
}

TEST(SmoothKeys, OneKeyAndKeysAtOneFrameHaveNoSlope) {
    const Eigen::VectorXd frames = Eigen::VectorXd::LinSpaced(9, 0, 8);
    const Eigen::VectorXd values = .1 * frames.array();
    EXPECT_EQ(smooth_keys(frames, values, Eigen::VectorXd::Constant(1, 4.), 1).slopes[0], 0);
    EXPECT_TRUE(smooth_keys(frames, values, Eigen::Vector2d(4, 4), 1).slopes.isZero());
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
