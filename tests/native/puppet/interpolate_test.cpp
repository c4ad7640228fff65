// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/puppet/interpolate.hpp>
#include <mimetic/puppet/low_lag_filter.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

MatrixRows random_rows(unsigned seed, int rows, int cols) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    return MatrixRows::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

Eigen::VectorXd all(int size, double value) { return Eigen::VectorXd::Constant(size, value); }

class BasisTest : public ::testing::TestWithParam<Basis> {};

TEST_P(BasisTest, MeetsItsExamplesWithoutRegularisation) {
    const MatrixRows scores = random_rows(1, 9, 4), states = random_rows(2, 9, 6);
    const Interpolation map(scores, states, all(6, 0), all(6, 1), {GetParam(), 1e-12});
    for (int k = 0; k < 9; ++k) {
        EXPECT_LT((map.state(scores.row(k).transpose()) - states.row(k).transpose()).norm(), 1e-4);
    }
}

TEST_P(BasisTest, ChoosesMoreRegularisationForNoisierExamples) {
    const MatrixRows scores = random_rows(3, 120, 2);
    MatrixRows clean(120, 1), noisy(120, 1);
    const MatrixRows noise = random_rows(4, 120, 1);
    for (int k = 0; k < 120; ++k) {
        clean(k, 0) = .5 + .3 * std::sin(3 * scores(k, 0)) * scores(k, 1);
        noisy(k, 0) = clean(k, 0) + .4 * (noise(k, 0) - .5);
    }
    InterpolationOptions options;
    options.basis = GetParam();
    const Interpolation of_clean(scores, clean, all(1, -1), all(1, 2), options);
    const Interpolation of_noisy(scores, noisy, all(1, -1), all(1, 2), options);
    EXPECT_LT(of_clean.regularisation(), of_noisy.regularisation());
    // Beside the truth, at places between the examples
    const MatrixRows others = random_rows(5, 200, 2);
    double missed = 0;
    for (int k = 0; k < 200; ++k) {
        const double truth = .5 + .3 * std::sin(3 * others(k, 0)) * others(k, 1);
        missed += std::pow(of_noisy.state(others.row(k).transpose())[0] - truth, 2) / 200;
    }
    EXPECT_LT(std::sqrt(missed), .06);  // of noise with a standard deviation of .115
    EXPECT_NEAR(of_noisy.std(others.row(0).transpose())[0], .115, .06);
}

TEST_P(BasisTest, IsLessSureFarFromEveryExample) {
    const MatrixRows scores = random_rows(6, 20, 3), states = random_rows(7, 20, 2);
    InterpolationOptions options;
    options.basis = GetParam();
    const Interpolation map(scores, states, all(2, 0), all(2, 1), options);
    EXPECT_GT(map.std(all(3, 4))[0], 3 * map.std(scores.row(0).transpose())[0]);
}

INSTANTIATE_TEST_SUITE_P(Bases, BasisTest, ::testing::Values(Basis::linear, Basis::gaussian));

TEST(Interpolation, IsLinearBetweenTwoExamplesOnALine) {
    MatrixRows scores(2, 1), states(2, 1);
    scores << .2, .8;
    states << 0, 1;
    const Interpolation map(scores, states, all(1, -5), all(1, 5), {Basis::linear, 1e-12});
    for (const double at : {.2, .35, .5, .65, .8}) {
        EXPECT_NEAR(map.state(all(1, at))[0], (at - .2) / .6, 1e-5);
    }
}

TEST(Interpolation, StaysWithinItsLimits) {
    const MatrixRows scores = random_rows(8, 6, 2), states = random_rows(9, 6, 3);
    const Interpolation map(scores, states, all(3, 0), all(3, 1));
    const Eigen::VectorXd far = map.state(all(2, 50));
    EXPECT_GE(far.minCoeff(), 0);
    EXPECT_LE(far.maxCoeff(), 1);
}

TEST(Interpolation, RefusesExamplesThatDoNotMatch) {
    EXPECT_THROW(Interpolation(random_rows(1, 3, 2), random_rows(2, 4, 2), all(2, 0), all(2, 1)),
                 InvalidInput);
    EXPECT_THROW(Interpolation(random_rows(1, 3, 2), random_rows(2, 3, 2), all(1, 0), all(2, 1)),
                 InvalidInput);
    const Interpolation map(random_rows(1, 3, 2), random_rows(2, 3, 2), all(2, 0), all(2, 1));
    EXPECT_THROW(map.state(all(3, 0)), InvalidInput);
}

TEST(HullWeights, AreTheNearestConvexCombination) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const MatrixRows corners = random_rows(seed, 7, 5);
        const Eigen::VectorXd state = 2 * random_rows(seed + 100, 5, 1).col(0) - all(5, .5);
        const Eigen::VectorXd weights = hull_weights(corners, state);
        EXPECT_NEAR(weights.sum(), 1, 1e-9);
        EXPECT_GE(weights.minCoeff(), 0);
        // No corner lies further in the direction of what is left: the condition of the optimum
        const Eigen::VectorXd at = corners.transpose() * weights;
        const Eigen::VectorXd left = state - at;
        EXPECT_LT((corners * left).maxCoeff() - at.dot(left), 1e-3 * (1 + left.norm()));
    }
}

TEST(HullWeights, OfAPointInsideGiveThePoint) {
    const MatrixRows corners = random_rows(3, 8, 4);
    const Eigen::VectorXd inside = corners.transpose() * all(8, .125);
    EXPECT_LT((corners.transpose() * hull_weights(corners, inside) - inside).norm(), 1e-3);
    const Eigen::VectorXd corner = corners.row(2).transpose();
    EXPECT_NEAR(hull_weights(corners, corner)[2], 1, 1e-2);
}

TEST(LowLagFilter, FollowsARampByTheLagItStates) {
    FilterOptions options;
    for (const double speed : {.1, 1., 6.}) {
        LowLagFilter filter(all(1, 1), options);
        const double seconds = 1. / 30;
        double value = 0;
        for (int frame = 0; frame < 120; ++frame) {
            value = filter.advance(all(1, speed * frame * seconds), seconds)[0];
        }
        EXPECT_NEAR(speed * 119 * seconds - value, speed * filter.lags()[0], 1e-6 * speed);
        EXPECT_LT(filter.lags()[0], options.lag);
    }
}

TEST(LowLagFilter, StillsNoiseAtRestAndPassesABlink) {
    LowLagFilter filter(all(1, 1));
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, .01);
    double raw = 0, filtered = 0;
    for (int frame = 0; frame < 600; ++frame) {
        const double value = noise(random);
        const double out = filter.advance(all(1, value), 1. / 30)[0];
        raw += value * value;
        filtered += frame ? out * out : 0;
    }
    EXPECT_LT(filtered, .45 * raw);
    double highest = 0;
    for (const double lid : {.5, 1., 1., .5, 0.}) {
        highest = std::max(highest, filter.advance(all(1, lid), 1. / 30)[0]);
    }
    EXPECT_GT(highest, .9);
}

TEST(LowLagFilter, TakesTheFirstValuesAndThoseAfterARestartAsTheyAre) {
    LowLagFilter filter(all(2, 1));
    EXPECT_EQ(filter.advance(all(2, .7), .04)[1], .7);
    EXPECT_LT(filter.advance(all(2, .1), .04)[0], .7);
    filter.restart();
    EXPECT_EQ(filter.advance(all(2, .3), .04)[0], .3);
    EXPECT_THROW(filter.advance(all(2, .3), 0), InvalidInput);
    EXPECT_THROW(LowLagFilter(all(2, 0)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
