// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/puppet/sharpening.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

constexpr double kFrame = 1. / 25;

ValuesWithStd one(double value, double std) {
    return {Eigen::VectorXd::Constant(1, value), Eigen::VectorXd::Constant(1, std)};
}

TEST(Sharpening, BeginsWithTheVariancesThatAreSaid) {
    Sharpening sharpening(1);
    const ValuesWithStd now = sharpening.advance(one(0, .1), one(.5, .1), 0);
    EXPECT_NEAR(now.values[0], .25, 1e-12);
    EXPECT_NEAR(now.std[0], .1 / std::sqrt(2.), 1e-12);
}

/// Root mean square errors of live, taught and sharpened values in the second of two minutes.
Eigen::Vector3d errors(double live_error, double taught_error, double said_live_std) {
    Sharpening sharpening(1);
    std::mt19937 random(3);
    std::normal_distribution<double> error;
    Eigen::Vector3d sums = Eigen::Vector3d::Zero();
    double bias = 0;
    constexpr int kFrames = 3000;
    for (int frame = 0; frame < kFrames; ++frame) {
        const double truth = .5 + .4 * std::sin(.05 * frame);
        // What is off stays off for a second or so
        bias += .04 * (-bias) + std::sqrt(.08) * live_error * error(random);
        const double live = truth + bias, taught = truth + taught_error * error(random);
        const ValuesWithStd now =
            sharpening.advance(one(live, said_live_std), one(taught, taught_error), kFrame);
        if (frame >= kFrames / 2) {
            const Eigen::Vector3d off(live - truth, taught - truth, now.values[0] - truth);
            sums += off.cwiseAbs2();
        }
    }
    return (sums / (kFrames / 2)).cwiseSqrt();
}

TEST(Sharpening, IsNearerThanEitherThoughLiveVarianceIsSaidFarTooSmall) {
    for (const auto& [live, taught] : {std::pair{.1, .1}, {.2, .05}, {.03, .1}}) {
        const Eigen::Vector3d rms = errors(live, taught, .005);
        EXPECT_LT(rms[2], 1.02 * std::min(rms[0], rms[1])) << live << " and " << taught;
        const double best = 1 / std::sqrt(1 / (rms[0] * rms[0]) + 1 / (rms[1] * rms[1]));
        EXPECT_LT(rms[2], 1.2 * best) << live << " and " << taught;
    }
}

TEST(Sharpening, ForgetsAnotherFace) {
    Sharpening sharpening(1);
    for (int frame = 0; frame < 500; ++frame) {
        sharpening.advance(one(0, .01), one(.5, .1), kFrame);
    }
    EXPECT_GT(sharpening.advance(one(0, .01), one(.5, .1), kFrame).values[0], .4);
    sharpening.restart();
    EXPECT_LT(sharpening.advance(one(0, .01), one(.5, .1), 0).values[0], .01);
}

TEST(Sharpening, RefusesWhatIsNoMeasurement) {
    EXPECT_THROW(Sharpening(0), InvalidInput);
    Sharpening sharpening(1);
    EXPECT_THROW(sharpening.advance(one(0, .1), one(NAN, .1), kFrame), InvalidInput);
    EXPECT_THROW(sharpening.advance(one(0, .1), one(0, 0), kFrame), InvalidInput);
    EXPECT_THROW(sharpening.advance(one(0, .1), one(0, .1), -1), InvalidInput);
    const ValuesWithStd two{Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2)};
    EXPECT_THROW(sharpening.advance(one(0, .1), two, kFrame), InvalidInput);
}

}  // namespace
}  // namespace mimetic
