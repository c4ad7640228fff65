// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/analyse/sparse_curve.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

constexpr double kTolerance = .02;

Eigen::VectorXd frames_to(int last) { return Eigen::VectorXd::LinSpaced(last, 1, last); }

Eigen::VectorXd drawn(const SparseCurve& curve, const Eigen::VectorXd& frames) {
    return frames.unaryExpr([&](double frame) { return curve.value(frame); });
}

/// An event by five keys, rest before and after it.
SparseCurve five_keys() {
    SparseCurve curve{Eigen::VectorXd(7), Eigen::VectorXd(7), Eigen::VectorXd(7)};
    curve.frames << 1, 21, 30, 38, 47, 64, 90;
    curve.values << 0, 0, .7, .55, .8, 0, 0;
    curve.slopes << 0, 0, .03, -.01, .01, 0, 0;
    return curve;
}

TEST(SparseCurve, ACurveOfFewKeysHasNoMoreOfThem) {
    const Eigen::VectorXd frames = frames_to(90), values = drawn(five_keys(), frames);
    const SparseCurve found = reduce_curve(frames, values, kTolerance);
    EXPECT_LE(found.frames.size(), 7);
    EXPECT_LE((drawn(found, frames) - values).cwiseAbs().maxCoeff(), kTolerance);
    EXPECT_LE(found.error, kTolerance);
}

TEST(SparseCurve, JitterCostsKeysOnlyWhereItIsBeyondTheTolerance) {
    const Eigen::VectorXd frames = frames_to(90);
    Eigen::VectorXd values = drawn(five_keys(), frames);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> jitter(-.6 * kTolerance, .6 * kTolerance);
    for (double& value : values.segment(21, 42)) {
        value = std::max(0., value + jitter(random));
    }
    const SparseCurve found = reduce_curve(frames, values, kTolerance);
    EXPECT_LE(found.frames.size(), 9);
    EXPECT_LE(found.error, kTolerance);
}

TEST(SparseCurve, WhatIsAtRestStaysAtRestBetweenEvents) {
    const Eigen::VectorXd one = drawn(five_keys(), frames_to(90));
    Eigen::VectorXd values(270);
    values << one, one, one;
    const Eigen::VectorXd frames = frames_to(270);
    const SparseCurve found = reduce_curve(frames, values, kTolerance);
    for (const double frame : {10., 80., 100., 170., 195., 265.}) {
        EXPECT_NEAR(found.value(frame), 0, 1e-6) << frame;
    }
    // Of one more event the others know nothing
    values.segment(90, 90) *= .5;
    const SparseCurve other = reduce_curve(frames, values, kTolerance);
    for (double frame = 1; frame <= 85; ++frame) {
        EXPECT_NEAR(other.value(frame), found.value(frame), 1e-6) << frame;
    }
}

/// One event in 90 rows, whose frames are `step` apart; the times of its phases with it.
struct HeldEvent {
    PhaseShape shape;
    Eigen::VectorXd frames, values;

    explicit HeldEvent(double step) : frames(Eigen::VectorXd::LinSpaced(90, 1, 1 + 89 * step)) {
        shape.amplitude = .8;
        shape.onset = 20 * step;
        shape.rise = 12 * step;
        shape.hold = 18 * step;
        shape.exponent = 2;
        shape.release_time = 4 * step;
        values = frames.unaryExpr([&](double frame) { return shape.value(frame); });
    }
    PhaseKeys reduced() const {
        return reduce_by_phases(frames, values, Eigen::VectorXd::Constant(90, .05), kTolerance);
    }
};

TEST(SparseCurve, PhasesKeepTheirKeys) {
    const HeldEvent event(1);
    const PhaseShape& shape = event.shape;
    const PhaseKeys keys = event.reduced();
    ASSERT_EQ(keys.keys_of_event.size(), 1U);
    EXPECT_LE(keys.keys_of_event[0], 7);  // its corners take two each, as handles are straight
    EXPECT_LE(keys.curve.error, kTolerance);
    for (const double phase : {shape.onset, shape.apex(), shape.release()}) {
        EXPECT_LE((keys.curve.frames.array() - phase).abs().minCoeff(), 2) << phase;
    }
}

TEST(SparseCurve, PhasesKeepTheirKeysWhereTheSceneHasSeveralFramesARow) {
    const HeldEvent event(2.5);  // 24 of 60 a second
    const PhaseShape& shape = event.shape;
    const PhaseKeys keys = event.reduced();
    ASSERT_EQ(keys.keys_of_event.size(), 1U);
    for (const double phase : {shape.onset, shape.apex(), shape.release()}) {
        EXPECT_LE((keys.curve.frames.array() - phase).abs().minCoeff(), 5) << phase;
    }
}

TEST(SparseCurve, AStillCurveHasOneKey) {
    const Eigen::VectorXd frames = frames_to(50);
    EXPECT_EQ(reduce_curve(frames, Eigen::VectorXd::Constant(50, .3), kTolerance).frames.size(), 1);
}

TEST(SparseCurve, WrongInputIsRefused) {
    const Eigen::VectorXd frames = frames_to(20);
    EXPECT_THROW(reduce_curve(frames, frames.head(9), kTolerance), InvalidInput);
    EXPECT_THROW(reduce_curve(frames.reverse(), frames, kTolerance), InvalidInput);
    EXPECT_THROW(reduce_curve(frames, frames, 0), InvalidInput);
}

}  // namespace
}  // namespace mimetic
