// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/analyse/delays.hpp>
#include <mimetic/analyse/phases.hpp>
#include <random>

#include "../sanitized.hpp"

namespace mimetic {
namespace {

using test::repeats;

constexpr int kFrames = 72;
const Eigen::VectorXd frames = Eigen::VectorXd::LinSpaced(kFrames, 1, kFrames);
const std::vector<bool> all(kFrames, true);

/// As `mimetic analyse` fits what the pictures say.
PhaseOptions by_pictures() {
    PhaseOptions options;
    options.measured_std = 1e-9;
    options.robust_scale = .02;
    options.exponent_std = 3;
    return options;
}

PhaseShape held_smile() {
    PhaseShape shape;
    shape.amplitude = .6;
    shape.onset = 10;
    shape.rise = 8;
    shape.hold = 42;
    shape.exponent = -2;
    shape.release_time = 1.5;
    return shape;
}

Eigen::VectorXd values_of(const PhaseShape& shape, double noise, int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal(0, noise);
    return frames.unaryExpr([&](double frame) { return shape.value(frame) + normal(random); });
}

Eigen::VectorXd bump(double at, double width) { return (-((frames.array() - at) / width).square()).exp(); }

std::vector<PhaseFit> fits_of(const Eigen::VectorXd& values, const PhaseOptions& options) {
    return fit_phases(frames, values, Eigen::VectorXd::Constant(kFrames, .05), all, options);
}

TEST(PhaseFit, AHoldWithADipAfterItsTopIsReleasedAtItsEnd) {
    for (int seed = 0; seed < repeats(6, 1); ++seed) {
        const Eigen::VectorXd curve =
            values_of(held_smile(), .006, seed) + .12 * bump(22, 3) - .1 * bump(32, 5) + .05 * bump(50, 6);
        const auto fits = fits_of(curve, by_pictures());
        ASSERT_EQ(fits.size(), 1U);
        EXPECT_NEAR(fits[0].release.value, 60, 1.5) << seed;
        EXPECT_NEAR(fits[0].onset.value, 10, 2) << seed;
        EXPECT_GT(fits[0].explained, .95) << seed;
    }
}

TEST(PhaseFit, WhatFallsInTheLastRowsIsReleasedWithinThem) {
    PhaseShape shape = held_smile();
    shape.hold = 51.5;
    shape.release_time = 1;
    for (int seed = 0; seed < repeats(12, 2); ++seed) {
        const Eigen::VectorXd curve = values_of(shape, .02, seed) + .12 * bump(22, 3) - .1 * bump(32, 5);
        const PhaseFit fit = fits_of(curve, by_pictures()).back();  // others are noise before it
        ASSERT_FALSE(fit.ends_after);
        EXPECT_LE(fit.shape.release(), frames[fit.last]) << seed;
        EXPECT_NEAR(fit.release.value, shape.release(), 1) << seed;
    }
}

TEST(PhaseFit, AFallInHeldFramesIsStillWithinTheRows) {
    for (int seed = 0; seed < repeats(4, 1); ++seed) {
        std::vector<bool> usable = all;
        for (int i = 50; i < kFrames; ++i) {
            usable[static_cast<std::size_t>(i)] = false;
        }
        const Eigen::VectorXd curve = values_of(held_smile(), .01, seed);
        const PhaseFit fit =
            fit_phases(frames, curve, Eigen::VectorXd::Constant(kFrames, .05), usable, by_pictures()).back();
        ASSERT_FALSE(fit.ends_after);
        EXPECT_GE(fit.shape.release(), 49) << seed;
        EXPECT_LE(fit.shape.release(), frames[fit.last]) << seed;
        EXPECT_LE(fit.release.upper, frames[fit.last] + 1) << seed;  // half a frame of timing
    }
}

/// Of two curves' rates, b's `lag` frames later, over rows first to last.
double correlation_at(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double lag, int first, int last) {
    const auto rate = [](const Eigen::VectorXd& values, int row) {
        return (values[row + 1] - values[row - 1]) / 2;
    };
    const int whole = static_cast<int>(std::floor(lag));
    double product = 0, one = 0, two = 0;
    for (int row = first; row <= last; ++row) {
        const double later =
            (1 - lag + whole) * rate(b, row + whole) + (lag - whole) * rate(b, row + whole + 1);
        product += rate(a, row) * later;
        one += std::pow(rate(a, row), 2);
        two += std::pow(rate(b, row), 2);
    }
    return product / std::sqrt(one * two);
}

TEST(Delays, TheCorrelationIsOfTheCurvesOwnRatesAtTheDelay) {
    PhaseShape early = held_smile(), late = held_smile();
    early.hold = late.hold = 12;
    early.onset = 24;
    late.onset = 25;
    late.rise = 14;
    late.exponent = 2;
    const Eigen::VectorXd first = values_of(early, .002, 1), second = values_of(late, .002, 2);
    const PhaseFit one = fits_of(first, by_pictures()).at(0), other = fits_of(second, by_pictures()).at(0);
    const Eigen::VectorXd cut = (second.array() - .3).max(0);  // its peak is not where the fits have it
    const auto delay = estimate_delay(frames, first, one, cut, other);
    ASSERT_TRUE(delay.has_value());
    const int begin = static_cast<int>(std::ceil(one.shape.onset - 4)) - 1;
    const int end = static_cast<int>(std::ceil(other.shape.apex() + 4)) - 1;
    EXPECT_NEAR(delay->correlation, correlation_at(first, cut, delay->lag.value, begin, end), .02);
    EXPECT_LT(delay->correlation, correlation_at(first, cut, delay->lag.value + 1, begin, end) - .03);
    EXPECT_LT(delay->chance, .15);
}

}  // namespace
}  // namespace mimetic
