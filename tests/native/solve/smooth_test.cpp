// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/solve.hpp>
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

FaceMotion two_muscles() {
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Identity(2, 3);
    motion.num_muscles = 2;
    motion.lower = Eigen::VectorXd::Zero(2);
    motion.upper = Eigen::VectorXd::Ones(2);
    motion.prior_std = Eigen::VectorXd::Constant(2, .3);
    return motion;
}

/// At some values of them, from which they are measured somewhere else.
FrameEstimate measured(const Eigen::Vector2d& values, const Eigen::Vector2d& measured_values, double noise) {
    FrameEstimate estimate;
    estimate.values = values;
    estimate.information = Eigen::MatrixXd::Identity(8, 8) / (noise * noise);
    estimate.covariance = estimate.information.inverse();
    estimate.gradient = Eigen::VectorXd::Zero(8);
    estimate.gradient.tail(2) = (measured_values - values) / (noise * noise);
    return estimate;
}

/// Two values whose sum is measured well and whose difference hardly, as of a lip's depressor and what closes
/// the lip, in a clip that ends while both move: what the difference does is reached in the last rounds.
TEST(Smooth, ReachesTheOptimumOfWhatIsHardlyMeasured) {
    FaceMotion motion = two_muscles();
    motion.lower.setConstant(-1);
    constexpr int kFrames = 280;
    Eigen::Matrix2d information;
    information << 20000, 19990, 19990, 20000;
    std::vector<FrameEstimate> estimates;
    for (int t = 0; t < kFrames; ++t) {
        const double sum = .4 * (1 + std::sin(.1 * t)), difference = .6 * std::sin(.06 * t);
        FrameEstimate estimate = measured({0, 0}, {0, 0}, .05);
        estimate.information.bottomRightCorner<2, 2>() = information;
        estimate.gradient.tail(2) = information * Eigen::Vector2d(sum + difference, sum - difference) / 2;
        estimates.push_back(estimate);
    }
    SmootherOptions many;
    many.max_iterations = 100000;
    const std::vector<FrameEstimate> reached = smooth(estimates, motion),
                                     wanted = smooth(estimates, motion, many);
    double largest = 0;
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        largest = std::max(largest, (reached[t].values - wanted[t].values).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(largest, .01);
}

/// Two values, the first measured each frame with noise about a rise and a fall.
TEST(Smooth, FollowsARiseWithoutLagAndWithinBounds) {
    const FaceMotion motion = two_muscles();
    constexpr int kFrames = 80;
    constexpr double kNoise = .05;
    std::mt19937 random(2);
    std::normal_distribution<double> normal(0, kNoise);
    Eigen::VectorXd truth(kFrames);
    std::vector<FrameEstimate> estimates(kFrames);
    for (int t = 0; t < kFrames; ++t) {
        truth[t] = std::clamp((t - 20) / 10., 0., 1.) * std::clamp((60 - t) / 10., 0., 1.);
        // As a filter leaves it: behind the truth by two frames, the measurement pulling ahead.
        estimates[static_cast<std::size_t>(t)] =
            measured({t < 2 ? 0 : truth[t - 2], 0}, {truth[t] + normal(random), 0}, kNoise);
    }
    const std::vector<FrameEstimate> smoothed = smooth(estimates, motion);
    Eigen::VectorXd values(kFrames);
    for (int t = 0; t < kFrames; ++t) {
        values[t] = smoothed[static_cast<std::size_t>(t)].values[0];
        EXPECT_GE(values[t], 0);
        EXPECT_LE(values[t], 1);
        EXPECT_LT(smoothed[static_cast<std::size_t>(t)].values[1], .01);
    }
    const auto distance = [&](int lag) {
        return (values.segment(10 + lag, kFrames - 20) - truth.segment(10, kFrames - 20)).squaredNorm();
    };
    EXPECT_LT(distance(0), distance(1));
    EXPECT_LT(distance(0), distance(-1));
    EXPECT_LT(std::sqrt(distance(0) / (kFrames - 20)), .05);
}

/// A muscle that is known badly enough to be pulled to rest where it does nothing.
TEST(Smooth, LetsARiseBeginWhenItBegins) {
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Identity(1, 3);
    motion.num_muscles = 1;
    motion.lower = Eigen::VectorXd::Zero(1);
    motion.upper = Eigen::VectorXd::Ones(1);
    motion.prior_std = Eigen::VectorXd::Constant(1, .3);
    constexpr int kRise = 30, kFrames = 60;
    constexpr double kNoise = .15, kIdle = .03;
    std::vector<FrameEstimate> estimates(kFrames);
    for (int t = 0; t < kFrames; ++t) {
        const double measured = std::clamp((t - kRise) / 10., kIdle, .8);
        FrameEstimate& estimate = estimates[static_cast<std::size_t>(t)];
        estimate.values = Eigen::VectorXd::Constant(1, measured);
        estimate.information = Eigen::MatrixXd::Identity(7, 7) / (kNoise * kNoise);
        estimate.covariance = estimate.information.inverse();
        estimate.gradient = Eigen::VectorXd::Zero(7);
    }
    const std::vector<FrameEstimate> smoothed = smooth(estimates, motion);
    const auto value = [&](int t) { return smoothed[static_cast<std::size_t>(t)].values[0]; };
    for (int t = 0; t < kRise - 10; ++t) {
        EXPECT_LT(value(t), .005) << "frame " << t;
    }
    int onset = 0;
    while (onset < kFrames - 1 && value(onset) < .2 * .8) {
        ++onset;
    }
    EXPECT_EQ(onset, kRise + 2);
}

/// Both muscles rise to their peaks and fall again, measured from within their bounds.
std::vector<FrameEstimate> rise_to(const Eigen::Vector2d& peaks) {
    constexpr int kFrames = 60;
    constexpr double kNoise = .05;
    std::vector<FrameEstimate> estimates(kFrames);
    for (int t = 0; t < kFrames; ++t) {
        const Eigen::Vector2d truth = std::sin(M_PI * t / (kFrames - 1)) * peaks;
        estimates[static_cast<std::size_t>(t)] = measured(truth.cwiseMin(1), truth, kNoise);
    }
    return estimates;
}

Eigen::Vector2d peaks_of(const std::vector<FrameEstimate>& estimates) {
    Eigen::Vector2d peaks = Eigen::Vector2d::Zero();
    for (const FrameEstimate& estimate : estimates) {
        peaks = peaks.cwiseMax(estimate.values);
    }
    return peaks;
}

SmootherOptions with_headroom(double headroom) {
    SmootherOptions options;
    options.muscle_headroom = headroom;
    return options;
}

TEST(Smooth, LetsAMuscleAtItsBoundGoAsFarAsItIsMeasuredWithinItsHeadroom) {
    const FaceMotion motion = two_muscles();
    const std::vector<FrameEstimate> estimates = rise_to({1.4, .7});
    const Eigen::Vector2d bound = peaks_of(smooth(estimates, motion));
    EXPECT_EQ(bound[0], 1);
    const Eigen::Vector2d free = peaks_of(smooth(estimates, motion, with_headroom(1.6)));
    EXPECT_NEAR(free[0], 1.4, .03);
    EXPECT_NEAR(free[1], bound[1], 1e-4);
    EXPECT_EQ(peaks_of(smooth(estimates, motion, with_headroom(1.2)))[0], 1.2);
}

TEST(Smooth, LeavesAMuscleThatIsHardlyAtWorkAsItIsWhereAnotherGoesFurther) {
    const FaceMotion motion = two_muscles();
    const std::vector<FrameEstimate> estimates = rise_to({1.4, .2});
    const std::vector<FrameEstimate> bound = smooth(estimates, motion);
    const std::vector<FrameEstimate> free = smooth(estimates, motion, with_headroom(1.6));
    EXPECT_GT(peaks_of(bound)[1], .05);
    EXPECT_LT(peaks_of(bound)[1], .19);  // it is pulled to rest
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        EXPECT_NEAR(free[t].values[1], bound[t].values[1], 1e-4);
    }
}

TEST(Smooth, GivesTheSameToTheBitWithHeadroomThatNoMuscleAsksFor) {
    const FaceMotion motion = two_muscles();
    const std::vector<FrameEstimate> estimates = rise_to({.9, .7});
    const std::vector<FrameEstimate> bound = smooth(estimates, motion);
    const std::vector<FrameEstimate> free = smooth(estimates, motion, with_headroom(1.6));
    for (std::size_t t = 0; t < estimates.size(); ++t) {
        EXPECT_EQ(free[t].values, bound[t].values);
        EXPECT_EQ(free[t].gradient, bound[t].gradient);
    }
}

TEST(Smooth, GivesNoHeadroomForFramesThatWereNotMeasured) {
    std::vector<FrameEstimate> estimates = rise_to({1.4, .7});
    for (FrameEstimate& estimate : estimates) {
        estimate.held = estimate.values[0] > .9;
    }
    EXPECT_LE(peaks_of(smooth(estimates, two_muscles(), with_headroom(1.6)))[0], 1);
}

TEST(Smooth, BringsAHeadThatIsLostWhileItMovesToRest) {
    constexpr int kFirst = 30, kLast = 50, kFrames = 130;  // measured in between
    constexpr double kTurn = .025;                         // radians a frame
    std::vector<FrameEstimate> estimates;
    for (int t = 0; t < kFrames; ++t) {
        const int at = std::clamp(t, kFirst, kLast);
        FrameEstimate estimate =
            measured({.1 + .02 * (at - kFirst), .3}, {.1 + .02 * (at - kFirst), .3}, .002);
        estimate.camera_from_head.linear() =
            Eigen::AngleAxisd(kTurn * (at - kFirst), Eigen::Vector3d::UnitY()).toRotationMatrix();
        estimate.camera_from_head.translation() << .001 * at, 0, .5;
        estimate.held = t != at;
        if (estimate.held) estimate.information.setZero();
        estimates.push_back(std::move(estimate));
    }
    const std::vector<FrameEstimate> smoothed = smooth(estimates, two_muscles());
    const auto turn_from = [&](int frame, int other) {
        return Eigen::AngleAxisd(
                   smoothed[static_cast<std::size_t>(frame)].camera_from_head.linear().transpose() *
                   smoothed[static_cast<std::size_t>(other)].camera_from_head.linear())
            .angle();
    };
    EXPECT_LT(turn_from(0, kFirst), 4 * kTurn);
    EXPECT_LT(turn_from(kFrames - 1, kLast), 4 * kTurn);
    EXPECT_LT(smoothed.back().values[0], .62);
    EXPECT_NEAR(turn_from(kFirst, kLast), kTurn * (kLast - kFirst), .02);
    EXPECT_NEAR(smoothed.back().camera_from_head.translation().x(), .001 * kLast, .005);
}

TEST(Smooth, GivesBoundsThatAreKnownToThoseMusclesAloneThatStandAtTheFirst) {
    const FaceMotion usual = two_muscles();
    FaceMotion known = usual;
    known.upper << 1.6, 1.3;
    SmootherOptions options;
    options.first_muscle_bound = 1;
    for (const double peak : {.9, 1.4}) {
        const std::vector<FrameEstimate> estimates = rise_to({peak, .7});
        const std::vector<FrameEstimate> captured = smooth(estimates, usual, with_headroom(1.6));
        const std::vector<FrameEstimate> refined = smooth(estimates, known, options);
        for (std::size_t t = 0; t < estimates.size(); ++t) {
            EXPECT_EQ(refined[t].values, captured[t].values);
        }
    }
}

/// Two muscles whose sum is measured well and whose difference hardly: the pull to rest decides of it.
TEST(Smooth, SolvesAPartAgainAsItWasBesideFramesThatStay) {
    const FaceMotion motion = two_muscles();
    Eigen::Matrix2d information;
    information << 200.5, 199.5, 199.5, 200.5;
    std::vector<FrameEstimate> estimates(60, measured({.6, .5}, {.6, .5}, .05));
    for (FrameEstimate& estimate : estimates) {
        estimate.information.bottomRightCorner<2, 2>() = information;
        estimate.covariance = estimate.information.inverse();
    }
    const std::vector<FrameEstimate> all = smooth(estimates, motion);
    EXPECT_GT(std::abs(all[20].values[1] - .5), .1);
    const std::vector<FrameEstimate> part(all.begin(), all.begin() + 40);
    SmootherOptions options;
    options.fixed_last = 12;
    const std::vector<FrameEstimate> again = smooth(part, motion, options);
    for (std::size_t t = 0; t < part.size(); ++t) {
        EXPECT_NEAR(again[t].values[1], part[t].values[1], .01) << "frame " << t;
    }
}

/// How high a short movement is after smoothing, of a clip of so many frames a second, in which the same is
/// known in a second.
double smoothed_peak(double rate, double told) {
    constexpr double kSeconds = 4, kPeak = .8, kWidth = .07;
    std::vector<FrameEstimate> estimates;
    for (int t = 0; t <= kSeconds * rate; ++t) {
        const double time = t / rate - kSeconds / 2;
        const double value = kPeak * std::exp(-.5 * std::pow(time / kWidth, 2));
        estimates.push_back(measured({0, 0}, {value, 0}, .1 * std::sqrt(rate / 25)));
    }
    SmootherOptions options;
    options.frame_rate = told;
    double peak = 0;
    for (const FrameEstimate& estimate : smooth(estimates, two_muscles(), options)) {
        peak = std::max(peak, estimate.values[0]);
    }
    return peak;
}

TEST(Smooth, LeavesAsMuchOfAShortMovementAtAnyFrameRate) {
    const double usual = smoothed_peak(25, 25);
    EXPECT_NEAR(smoothed_peak(24, 24), smoothed_peak(24, 30), 1e-12);
    for (const double rate : {15., 50., 100.}) {
        EXPECT_NEAR(smoothed_peak(rate, rate), usual, .03) << rate;
        EXPECT_GT(std::abs(smoothed_peak(rate, 30) - usual), .05) << rate;
    }
    SmootherOptions none;
    none.frame_rate = 0;
    EXPECT_THROW(none.check(), InvalidInput);
}

TEST(Smooth, RejectsHeadroomThatIsNoneAndABoundThatLeavesNoRoom) {
    EXPECT_THROW(smooth(rise_to({1, 1}), two_muscles(), with_headroom(.9)), std::invalid_argument);
    SmootherOptions options;
    options.first_muscle_bound = 0;
    EXPECT_THROW(smooth(rise_to({1, 1}), two_muscles(), options), std::invalid_argument);
}

TEST(Smooth, RejectsEstimatesOfAnotherFace) {
    FaceMotion motion;
    motion.lower = motion.upper = motion.prior_std = Eigen::VectorXd::Ones(3);
    EXPECT_THROW(smooth({FrameEstimate()}, motion), std::invalid_argument);
    SmootherOptions options;
    options.value_acceleration = 0;
    EXPECT_THROW(smooth({}, motion, options), std::invalid_argument);
}

/// A muscle and its antagonist, of which only the difference shows.
TEST(Smooth, TakesAMuscleAloneForAMuscleAgainstItsAntagonist) {
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Zero(2, 3);
    motion.modes.col(1) << .01, -.01;
    motion.num_muscles = 2;
    motion.lower = Eigen::VectorXd::Zero(2);
    motion.upper = Eigen::VectorXd::Ones(2);
    motion.prior_std = Eigen::VectorXd::Constant(2, .3);
    std::vector<FrameEstimate> estimates(30);
    for (FrameEstimate& estimate : estimates) {
        estimate.values = Eigen::Vector2d(.8, .4);
        estimate.information = 1e4 * Eigen::MatrixXd::Identity(8, 8);
        estimate.information.bottomRightCorner<2, 2>() << 401, -400, -400, 401;
        estimate.covariance = estimate.information.inverse();
        estimate.gradient = Eigen::VectorXd::Zero(8);
    }
    for (const FrameEstimate& estimate : smooth(estimates, motion)) {
        EXPECT_NEAR(estimate.values[0], .4, .1);
        EXPECT_LT(estimate.values[1], .02);
    }
}

}  // namespace
}  // namespace mimetic
