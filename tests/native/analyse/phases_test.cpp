// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/analyse/curve_noise.hpp>
#include <mimetic/analyse/delays.hpp>
#include <mimetic/analyse/group_curves.hpp>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

#include "../sanitized.hpp"

namespace mimetic {
namespace {

using test::repeats;

constexpr int kFrames = 90;
const Eigen::VectorXd frames = Eigen::VectorXd::LinSpaced(kFrames, 1, kFrames);
const Eigen::VectorXd stds = Eigen::VectorXd::Constant(kFrames, .05);
const std::vector<bool> all(kFrames, true);

PhaseShape smile(double onset) {
    PhaseShape shape;
    shape.amplitude = .7;
    shape.onset = onset;
    shape.rise = 11;
    shape.hold = 8;
    shape.exponent = -2;
    shape.release_time = 4;
    return shape;
}

/// What a capture makes of a shape: the smoother's response, and noise as it correlates it.
Eigen::VectorXd captured(const PhaseShape& shape, double noise, int seed) {
    const CurveNoise smoother(kFrames, smoothing_ratio(stds[0]));
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    Eigen::VectorXd curve(kFrames), error(kFrames);
    for (int i = 0; i < kFrames; ++i) {
        curve[i] = shape.value(frames[i]);
        error[i] = normal(random);
    }
    return smoother.smoothed(curve) + noise * smoother.correlated(error);
}

/// The largest event; smaller ones may be noise.
PhaseFit largest_of(const std::vector<PhaseFit>& fits) {
    return *std::max_element(fits.begin(), fits.end(), [](const PhaseFit& one, const PhaseFit& other) {
        return one.shape.amplitude < other.shape.amplitude;
    });
}

PhaseFit largest_event(const Eigen::VectorXd& curve) {
    return largest_of(fit_phases(frames, curve, stds, all));
}

TEST(PhaseShape, IsContinuousAndAnExponentNearZeroIsStraight) {
    PhaseShape shape = smile(10.3);
    shape.model = PhaseModel::two_exponentials;
    shape.relaxation_time = 14;
    shape.relaxed_share = .3;
    shape.drift = -.2;
    for (const double at : {shape.onset, shape.apex(), shape.release()}) {
        EXPECT_NEAR(shape.value(at - 1e-7), shape.value(at + 1e-7), 1e-6);
    }
    EXPECT_NEAR(shape.value(shape.apex()), .7, 1e-9);
    EXPECT_NEAR(shape.value(shape.release()), .56, 1e-9);
    shape.exponent = 1e-5;
    EXPECT_NEAR(shape.value(shape.onset + 5.5), .35, 1e-5);
}

TEST(PhaseShape, AFallEndsWhereATenthIsLeft) {
    PhaseShape shape = smile(10);
    shape.drift = -.2;
    for (const PhaseModel model : {PhaseModel::one_exponential, PhaseModel::two_exponentials}) {
        for (const double share : {.05, .1, .11, .15, .25, .5, .8}) {
            shape.model = model;
            shape.release_time = 5;
            shape.relaxation_time = 15;
            shape.relaxed_share = share;
            const double height = shape.value(shape.release());
            EXPECT_NEAR(shape.value(shape.release() + shape.fall_time()), .1 * height, 1e-9) << share;
        }
    }
    shape.relaxed_share = .15;
    EXPECT_NEAR(shape.fall_time(), 14.8, .05);  // the slow part alone is a tenth after 6.1
    shape.model = PhaseModel::linear_ramp;
    EXPECT_NEAR(shape.value(shape.release() + shape.fall_time()), .1 * .56, 1e-9);
}

TEST(Phases, TheLengthContainsHowUncertainTheFallIs) {
    PhaseShape truth = smile(12);
    truth.model = PhaseModel::two_exponentials;
    truth.release_time = 3;
    truth.relaxation_time = 12;
    truth.relaxed_share = .3;
    const double length = truth.release() + truth.fall_time() - truth.onset;
    int held = 0;
    constexpr int kTrials = repeats(10, 2);
    for (int seed = 0; seed < kTrials; ++seed) {
        const PhaseFit fit = fit_phases(frames, captured(truth, .01, seed), stds, all).at(0);
        const double ends =
            std::hypot(fit.onset.upper - fit.onset.lower, fit.release.upper - fit.release.lower);
        EXPECT_GT(fit.length.upper - fit.length.lower, ends);
        held += fit.length.lower <= length && length <= fit.length.upper;
    }
    EXPECT_GE(held, kTrials - 2);
}

TEST(CurveNoise, KeepsStraightLinesAndItsErrorsAreAsLargeAsAsked) {
    const CurveNoise noise(kFrames, 3);
    EXPECT_TRUE(noise.smoothed(frames).isApprox(frames, 1e-9));
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd draws(kFrames, 400);
    for (Eigen::Index i = 0; i < draws.size(); ++i) {
        draws(i) = normal(random);
    }
    const Eigen::MatrixXd errors = noise.correlated(draws);
    EXPECT_NEAR(std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size())), 1, .03);
    EXPECT_GT((errors.topRows(kFrames - 1).cwiseProduct(errors.bottomRows(kFrames - 1))).mean(), .5);
    EXPECT_LT(noise.effective_count(), kFrames / 2);
    EXPECT_THROW(CurveNoise(2, 1), InvalidInput);
}

TEST(Phases, AKnownEventIsRecoveredWithItsIntervals) {
    int onsets_held = 0;
    constexpr int kTrials = repeats(12, 2);
    for (int seed = 0; seed < kTrials; ++seed) {
        const PhaseShape truth = smile(20.4);
        auto fits = fit_phases(frames, captured(truth, .01, seed), stds, all);
        std::erase_if(fits, [](const PhaseFit& fit) { return !fit.is_certain; });  // noise
        ASSERT_EQ(fits.size(), 1U);
        const PhaseFit& fit = fits[0];
        EXPECT_NEAR(fit.onset.value, truth.onset, 1.2);
        EXPECT_NEAR(fit.release.value, truth.release(), .8);
        EXPECT_NEAR(fit.amplitude.value, .7, .03);
        EXPECT_GT(fit.explained, .99);
        EXPECT_GE(fit.explained, fit.linear_explained);
        EXPECT_TRUE(fit.is_certain);
        EXPECT_FALSE(fit.begins_before || fit.ends_after);
        onsets_held += fit.onset.lower <= truth.onset && truth.onset <= fit.onset.upper;
    }
    EXPECT_GE(onsets_held, kTrials - 3);
}

TEST(Phases, AShapeThatMayBeDistortedHasWiderExponentsButNoOtherEstimate) {
    const Eigen::VectorXd curve = captured(smile(20.4), .004, 1);
    PhaseOptions options;
    const PhaseFit plain = fit_phases(frames, curve, stds, all, options).at(0);
    options.shape_error = 2.5;
    const PhaseFit fit = fit_phases(frames, curve, stds, all, options).at(0);
    EXPECT_EQ(fit.exponent.value, plain.exponent.value);
    EXPECT_GT(fit.exponent.upper - fit.exponent.lower, 1.5 * (plain.exponent.upper - plain.exponent.lower));
}

TEST(Phases, AnEventFarWithinTheErrorHasIntervals) {
    PhaseShape weak = smile(20);
    weak.amplitude = .06;
    PhaseOptions options;
    options.shape_error = 100;
    const PhaseFit fit = fit_phases(frames, captured(weak, .0005, 6), stds, all, options).at(0);
    EXPECT_LT(fit.onset.lower, fit.onset.upper);
    EXPECT_TRUE(draw_curves(fit, frames, 50, 1).allFinite());
}

TEST(Phases, AnExponentThatTheCurveHardlyTellsIsDrawnToWhatIsExpected) {
    PhaseOptions options;
    double free = 0, expected = 0;
    for (int seed = 0; seed < repeats(4, 2); ++seed) {
        PhaseShape shape = smile(20);
        shape.exponent = 5;
        const Eigen::VectorXd curve = captured(shape, .03, seed);
        options.exponent_std = 0;
        free += std::abs(fit_phases(frames, curve, stds, all, options).at(0).shape.exponent);
        options.exponent_std = 1;
        expected += std::abs(fit_phases(frames, curve, stds, all, options).at(0).shape.exponent);
    }
    EXPECT_LT(expected, .9 * free);
}

TEST(Phases, TheModelIsTheOneThatMadeTheCurve) {
    PhaseShape shape = smile(20);
    shape.model = PhaseModel::linear_ramp;
    shape.release_time = 9;
    EXPECT_EQ(fit_phases(frames, captured(shape, .004, 1), stds, all).at(0).shape.model, shape.model);
    shape.model = PhaseModel::two_exponentials;
    shape.release_time = 3;
    shape.relaxation_time = 15;
    shape.relaxed_share = .3;
    const PhaseFit fit = fit_phases(frames, captured(shape, .002, 2), stds, all).at(0);
    EXPECT_EQ(fit.shape.model, shape.model);
    EXPECT_NEAR(fit.shape.exponent, -2, .5);
}

TEST(Phases, EveryEventOfAClipIsFoundAndNoneInStillness) {
    Eigen::VectorXd two = captured(smile(8), .003, 3) + captured(smile(52), .003, 4);
    const auto fits = fit_phases(frames, two, stds, all);
    ASSERT_EQ(fits.size(), 2U);
    EXPECT_NEAR(fits[0].onset.value, 8, 1);
    EXPECT_NEAR(fits[1].onset.value, 52, 1);
    EXPECT_TRUE(fit_phases(frames, captured(smile(500), .004, 5), stds, all).empty());
    PhaseShape weak = smile(20);
    weak.amplitude = .07;
    for (const PhaseFit& fit : fit_phases(frames, captured(weak, .001, 6), stds, all)) {
        EXPECT_FALSE(fit.is_certain);  // the capture may be wrong by as much
    }
}

TEST(Phases, WhatTheClipCutsIsMarked) {
    EXPECT_TRUE(fit_phases(frames, captured(smile(-8), .002, 7), stds, all).at(0).begins_before);
    const PhaseFit late = fit_phases(frames, captured(smile(74), .002, 8), stds, all).at(0);
    EXPECT_TRUE(late.ends_after);
    EXPECT_NEAR(late.onset.value, 74, 1);
}

TEST(Phases, WhatIsHeldWhereAClipOrASceneBeginsOrEndsIsMarkedWhateverItsNoise) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0, .01);
    for (const bool has_cut : {false, true}) {
        PhaseOptions options;
        const Eigen::Index begin = has_cut ? 15 : 0;
        if (has_cut) {
            options.scene_starts = {frames[begin]};
        }
        for (int trial = 0; trial < repeats(10, 2); ++trial) {
            Eigen::VectorXd held = Eigen::VectorXd::Zero(kFrames);
            for (Eigen::Index i = begin; i < kFrames; ++i) {
                held[i] = .6 * std::clamp((60. - static_cast<double>(i)) / 8, 0., 1.) + normal(random);
            }
            const auto fits = fit_phases(frames, held, stds, all, options);
            ASSERT_FALSE(fits.empty());
            const PhaseFit top = largest_of(fits);
            EXPECT_TRUE(top.begins_before) << has_cut << trial;
            EXPECT_EQ(top.first, begin);
            if (!has_cut) {
                const Eigen::VectorXd turned = held.reverse();
                EXPECT_TRUE(largest_event(turned).ends_after) << trial;
            }
        }
    }
}

TEST(Phases, OfAnEventThatLastsAMinuteWhatIsAboutItsPeakIsFitted) {
    const int count = 1500;
    const Eigen::VectorXd rows = Eigen::VectorXd::LinSpaced(count, 1, count);
    PhaseShape held;
    held.amplitude = .4;
    held.onset = 50;
    held.rise = 15;
    held.hold = 1300;
    held.release_time = 10;
    Eigen::VectorXd curve = rows.unaryExpr([&](double frame) { return held.value(frame); });
    curve += .05 * (-((rows.array() - 1165) / 40).square()).exp().matrix();
    PhaseOptions options;
    options.num_draws = repeats(options.num_draws, 10);
    const auto fits = fit_phases(rows, curve, Eigen::VectorXd::Constant(count, .05),
                                 std::vector<bool>(static_cast<std::size_t>(count), true), options);
    ASSERT_EQ(fits.size(), 1U);
    EXPECT_LT(rows[fits[0].first], 1165);
    EXPECT_GT(rows[fits[0].last], 1165);
    EXPECT_TRUE(fits[0].begins_before);
}

TEST(Phases, HeldFramesSayNothing) {
    Eigen::VectorXd curve = captured(smile(20), .001, 9);
    std::vector<bool> usable = all;
    for (int i = 30; i < 34; ++i) {
        curve[i] += .05;
        usable[static_cast<std::size_t>(i)] = false;
    }
    EXPECT_NEAR(fit_phases(frames, curve, stds, usable).at(0).amplitude.value, .7, .01);
}

TEST(Phases, WrongInputIsRefused) {
    EXPECT_THROW(fit_phases(frames, frames.head(5), stds, all), InvalidInput);
    EXPECT_THROW(fit_phases(frames, frames * std::numeric_limits<double>::quiet_NaN(), stds, all),
                 InvalidInput);
    EXPECT_THROW(fit_phases(-frames, frames, stds, all), InvalidInput);
    PhaseOptions options;
    options.num_draws = -1;
    EXPECT_THROW(fit_phases(frames, frames, stds, all, options), InvalidInput);
}

TEST(Delays, ThreeFramesAreFoundAndNoneWhereThereIsNone) {
    int reported = 0;
    for (int seed = 0; seed < repeats(8, 2); ++seed) {
        const Eigen::VectorXd first = captured(smile(20), .01, 20 + seed);
        const Eigen::VectorXd late = .8 * captured(smile(23), .01, 40 + seed);
        const Eigen::VectorXd same = .8 * captured(smile(20), .01, 60 + seed);
        const PhaseFit one = largest_event(first);
        const auto delay = estimate_delay(frames, first, one, late, largest_event(late));
        ASSERT_TRUE(delay.has_value());
        EXPECT_NEAR(delay->lag.value, 3, .7);
        EXPECT_TRUE(delay->is_delayed);
        const auto none = estimate_delay(frames, first, one, same, largest_event(same));
        ASSERT_TRUE(none.has_value());
        EXPECT_NEAR(none->lag.value, 0, .7);
        reported += none->is_delayed;
    }
    EXPECT_LE(reported, 1);
}

TEST(Delays, AFootThatIsCutOffOneCurveDoesNotMoveTheLag) {
    PhaseShape slow = smile(23);
    slow.exponent = 2;
    const Eigen::VectorXd first = captured(smile(20), .003, 1), whole = captured(slow, .003, 2);
    const PhaseFit one = largest_event(first), other = largest_event(whole);
    const Eigen::VectorXd cut = (whole.array() - .2).max(0);  // drawn to rest, as weak muscles are
    const auto of_whole = estimate_delay(frames, first, one, whole, other);
    const auto of_cut = estimate_delay(frames, first, one, cut, other);
    ASSERT_TRUE(of_whole && of_cut);
    EXPECT_NEAR(of_cut->lag.value, of_whole->lag.value, .05);
    EXPECT_LT(of_cut->lag.upper - of_cut->lag.lower, 2);
}

TEST(Delays, AreInFramesWhereRowsAreSeveralApartAndNotToldOverACut) {
    const Eigen::VectorXd first = captured(smile(20), .003, 1), late = captured(smile(26), .003, 2);
    const PhaseFit one = largest_event(first), other = largest_event(late);
    const Eigen::VectorXd half = frames(Eigen::seqN(0, kFrames / 2, 2));
    const Eigen::VectorXd first_half = first(Eigen::seqN(0, kFrames / 2, 2));
    const Eigen::VectorXd late_half = late(Eigen::seqN(0, kFrames / 2, 2));
    const Eigen::VectorXd half_stds = Eigen::VectorXd::Constant(kFrames / 2, stds[0]);
    const std::vector<bool> half_all(kFrames / 2, true);
    const auto of_half = [&](const Eigen::VectorXd& curve) {
        return largest_of(fit_phases(half, curve, half_stds, half_all));
    };
    const auto delay = estimate_delay(half, first_half, of_half(first_half), late_half, of_half(late_half));
    ASSERT_TRUE(delay.has_value());
    EXPECT_NEAR(delay->lag.value, 6, .5);
    DelayOptions cut;
    cut.scene_starts = {23};
    EXPECT_TRUE(estimate_delay(frames, first, one, late, other).has_value());
    EXPECT_FALSE(estimate_delay(frames, first, one, late, other, cut).has_value());
}

TEST(Delays, WhatIsUncertainCutOrFarAwayGivesNone) {
    const Eigen::VectorXd first = captured(smile(20), .003, 1), second = captured(smile(45), .003, 2);
    const PhaseFit one = fit_phases(frames, first, stds, all).at(0);
    PhaseFit other = fit_phases(frames, second, stds, all).at(0);
    EXPECT_FALSE(estimate_delay(frames, first, one, second, other).has_value());
    other = one;
    EXPECT_TRUE(estimate_delay(frames, first, one, first, other).has_value());
    other.is_certain = false;
    EXPECT_FALSE(estimate_delay(frames, first, one, first, other).has_value());
    other = one;
    other.begins_before = true;
    EXPECT_FALSE(estimate_delay(frames, first, one, first, other).has_value());
    EXPECT_THROW(estimate_delay(frames, first.head(9), one, first, one), InvalidInput);
}

TEST(GroupCurves, AMeanIsLessUncertainThanItsMembers) {
    MatrixRows values(2, 3), errors = MatrixRows::Constant(2, 3, .2), members(2, 3);
    values << .2, .4, .9, 0, 1, .5;
    members << 1, 1, 0, 0, 0, 0;
    const MeanCurves means = mean_curves(values, errors, members);
    EXPECT_NEAR(means.values(0, 0), .3, 1e-12);
    EXPECT_NEAR(means.stds(0, 0), .2 / std::sqrt(2), 1e-12);
    EXPECT_NEAR(means.measured_std[0], .2, 1e-12);
    EXPECT_EQ(means.values(0, 1), 0);
    EXPECT_THROW(mean_curves(values, errors, members.leftCols(2)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
