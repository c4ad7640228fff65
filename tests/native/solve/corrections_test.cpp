// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/solve/corrections.hpp>
#include <mimetic/solve/stored_evidence.hpp>

#include "solve/evidence_bias.hpp"

namespace mimetic {
namespace {

constexpr int kFrames = 60, kNumValues = 3, kSize = 6 + kNumValues;
constexpr int kSpoilt = 25, kHealed = 35;  // first spoilt frame, first good one
constexpr double kNoise = .03;

const Camera kCamera{600, 600, 319.5, 239.5, 640, 480};

/// A point that the first value moves to the side, the second up; the third moves another one.
FaceMotion motion() {
    FaceMotion motion;
    motion.neutral = Points::Zero(1, 3);
    motion.modes = MatrixRows::Zero(kNumValues, 3);
    motion.modes(0, 0) = .01;
    motion.modes(1, 1) = .01;
    motion.num_muscles = kNumValues;
    motion.lower = Eigen::VectorXd::Zero(kNumValues);
    motion.upper = Eigen::VectorXd::Ones(kNumValues);
    motion.prior_std = Eigen::VectorXd::Constant(kNumValues, .45);
    return motion;
}

Eigen::VectorXd truth() { return Eigen::Vector3d(.5, .4, .3); }

/// What pictures say in which for ten frames an occluder hides that the first two values are above 0.
std::vector<FrameEstimate> spoilt_estimates() {
    std::vector<FrameEstimate> estimates(kFrames);
    for (int t = 0; t < kFrames; ++t) {
        FrameEstimate& estimate = estimates[static_cast<std::size_t>(t)];
        estimate.camera_from_head = Eigen::Translation3d(0, 0, .6) * Eigen::Isometry3d::Identity();
        estimate.values = truth();
        if (t >= kSpoilt && t < kHealed) {
            estimate.values.head<2>() << .1, .05;
        }
        estimate.information = Eigen::MatrixXd::Identity(kSize, kSize) / (kNoise * kNoise);
        estimate.information.topLeftCorner<6, 6>() *= 1e3;
        estimate.covariance = estimate.information.inverse();
        estimate.gradient = Eigen::VectorXd::Zero(kSize);
    }
    return estimates;
}

SkinPin pin_of_truth() {
    SkinPin pin{Eigen::Vector3d(0, 0, .08), MatrixRows::Zero(kNumValues, 3), {}, 1};
    pin.modes(0, 0) = pin.modes(1, 1) = .01;
    const Eigen::Vector3d point = pin.neutral + pin.modes.transpose() * truth() + Eigen::Vector3d(0, 0, .6);
    pin.pixel = kCamera.project(point);
    return pin;
}

double error_within(const std::vector<FrameEstimate>& estimates, int first, int end) {
    double sum = 0;
    for (int t = first; t < end; ++t) {
        sum += (estimates[static_cast<std::size_t>(t)].values - truth()).squaredNorm();
    }
    return std::sqrt(sum / (end - first));
}

std::vector<FrameEstimate> corrected(const std::vector<Correction>& corrections) {
    return smooth_corrected(spoilt_estimates(), motion(), kCamera, corrections);
}

TEST(Corrections, TwoPinsMendWhatAnOccluderSpoilt) {
    const std::vector<FrameEstimate> before = smooth(spoilt_estimates(), motion());
    const std::vector<FrameEstimate> after =
        corrected({{27, 8, {pin_of_truth()}, {}, {}}, {32, 8, {pin_of_truth()}, {}, {}}});
    EXPECT_GT(error_within(before, kSpoilt, kHealed), .3);
    EXPECT_LT(error_within(after, kSpoilt, kHealed), error_within(before, kSpoilt, kHealed) / 4);
}

TEST(Corrections, AFrameBeyondTheReachStaysAsItWas) {
    const std::vector<FrameEstimate> before = smooth(spoilt_estimates(), motion());
    const std::vector<FrameEstimate> after = corrected({{30, 6, {pin_of_truth()}, {}, {}}});
    for (int t = 0; t < kFrames; ++t) {
        const auto at = static_cast<std::size_t>(t);
        const double moved = (after[at].values - before[at].values).cwiseAbs().maxCoeff();
        if (std::abs(t - 30) > 10) {
            EXPECT_LT(moved, 1e-3) << "frame " << t;
        }
    }
}

TEST(Corrections, APinsPointLandsWithinItsDeviation) {
    const SkinPin pin = pin_of_truth();
    const FrameEstimate there = corrected({{30, 6, {pin}, {}, {}}})[30];
    const Eigen::Vector3d point = pin.neutral + pin.modes.transpose() * there.values;
    EXPECT_LT((kCamera.project(there.camera_from_head * point) - pin.pixel).norm(), pin.std);
}

TEST(Corrections, WhatIsNotMeasuredStays) {
    const std::vector<FrameEstimate> before = smooth(spoilt_estimates(), motion());
    const std::vector<FrameEstimate> after =
        corrected({{30, 6, {}, {}, {{Eigen::VectorXd::Unit(kNumValues, 0), .5, .02}}}});
    EXPECT_NEAR(after[30].values[0], .5, .02);
    EXPECT_NEAR(after[30].values[1], before[30].values[1], 2e-3);
    EXPECT_NEAR(after[30].values[2], before[30].values[2], 2e-3);
    const Eigen::Vector3d moved =
        after[30].camera_from_head.translation() - before[30].camera_from_head.translation();
    EXPECT_LT(moved.norm(), 1e-4);
}

TEST(Corrections, AValueAtItsBoundLeavesTheRestToOthers) {
    FaceMotion two = motion();
    two.modes.row(1) << -.01, 0, 0;  // the second value undoes the first
    SkinPin pin{Eigen::Vector3d(0, 0, .08), two.modes, {}, .5};
    std::vector<FrameEstimate> estimates = spoilt_estimates();
    for (FrameEstimate& estimate : estimates) {
        estimate.values << .1, .1, .3;
    }
    // 6 mm to the side of where it is: the second value ends at 0, the first does the rest
    pin.pixel = kCamera.project(Eigen::Vector3d(.006, 0, .68));
    const FrameEstimate there = smooth_corrected(estimates, two, kCamera, {{30, 6, {pin}, {}, {}}})[30];
    EXPECT_GE(there.values[1], 0);
    EXPECT_LT(there.values[1], .02);
    const Eigen::Vector3d point = pin.neutral + pin.modes.transpose() * there.values;
    EXPECT_LT((kCamera.project(there.camera_from_head * point) - pin.pixel).norm(), pin.std);
}

TEST(Corrections, APoseIsTakenWhereNothingWasSeen) {
    std::vector<FrameEstimate> estimates = spoilt_estimates();
    for (int t = 20; t < 40; ++t) {
        FrameEstimate& estimate = estimates[static_cast<std::size_t>(t)];
        estimate.held = true;
        estimate.information.setZero();
    }
    Eigen::Isometry3d pose = estimates[0].camera_from_head;
    pose.translation().x() = .05;
    pose.rotate(Eigen::AngleAxisd(.2, Eigen::Vector3d::UnitY()));
    const Correction correction{30, 8, {}, {{pose, .01, .001}}, {}};
    const auto after = smooth_corrected(estimates, motion(), kCamera, {correction});
    EXPECT_LT((after[30].camera_from_head.translation() - pose.translation()).norm(), 1e-3);
    EXPECT_LT((after[30].camera_from_head.linear() - pose.linear()).norm(), .01);
    EXPECT_GT(after[25].camera_from_head.translation().x(), .01);
    EXPECT_LT(std::abs(after[5].camera_from_head.translation().x()), 1e-3);
}

TEST(Corrections, FixedEndsKeepTheirStates) {
    SmootherOptions options;
    options.fixed_first = options.fixed_last = 5;
    const std::vector<FrameEstimate> before = spoilt_estimates();
    const auto after =
        smooth_corrected(before, motion(), kCamera,
                         {{8, 8, {}, {}, {{Eigen::VectorXd::Unit(kNumValues, 2), .9, .02}}}}, options);
    EXPECT_NEAR(after[8].values[2], .9, .02);
    for (std::size_t t = 0; t < 5; ++t) {
        EXPECT_EQ(after[t].values, before[t].values);
        EXPECT_EQ(after[kFrames - 1 - t].values, before[kFrames - 1 - t].values);
    }
}

/// Solved again without them, the pictures' own states come back: a correction is never lost in its result.
TEST(Corrections, AreTakenBackWithoutThem) {
    const std::vector<FrameEstimate> before = smooth(spoilt_estimates(), motion());
    const auto again =
        smooth_corrected(corrected({{30, 6, {pin_of_truth()}, {}, {}}}), motion(), kCamera, {});
    for (std::size_t t = 0; t < kFrames; ++t) {
        EXPECT_LT((again[t].values - before[t].values).cwiseAbs().maxCoeff(), 2e-3) << "frame " << t;
    }
}

TEST(Corrections, RowsAreTheDerivativesOfWhatIsMeasured) {
    Correction correction{0, 8, {pin_of_truth()}, {}, {{Eigen::Vector3d(1, -1, 0), .2, .1}}};
    const FrameEstimate estimate = spoilt_estimates()[30];
    const FaceState state{estimate.camera_from_head, estimate.values};
    const CorrectionRows rows = linearised(correction, kCamera, state);
    ASSERT_EQ(rows.residual.size(), 3);
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < kSize; ++i) {
        FaceState moved = state;
        moved.apply(FaceStep(kStep * Eigen::VectorXd::Unit(kSize, i)));
        const Eigen::VectorXd change =
            (rows.residual - linearised(correction, kCamera, moved).residual) / kStep;
        EXPECT_LT((change - rows.rows.col(i)).norm(), 1e-2 + 1e-3 * change.norm()) << "unknown " << i;
    }
}

TEST(Corrections, InfluenceFallsToNothingAtTheReach) {
    EXPECT_EQ(bias_correlation(0, 8), 1);
    EXPECT_NEAR(bias_correlation(.386 * 8, 8), .5, .01);
    EXPECT_EQ(bias_correlation(8, 8), 0);
    EXPECT_EQ(bias_correlation(-20, 8), 0);
}

TEST(Corrections, OfAnotherFaceAreRefused) {
    const FaceMotion face = motion();
    const auto refuse = [&](const Correction& correction) {
        EXPECT_THROW(smooth_corrected(spoilt_estimates(), face, kCamera, {correction}),
                     std::invalid_argument);
    };
    refuse({kFrames, 8, {}, {}, {}});
    refuse({3, 0, {}, {}, {}});
    refuse({3, 8, {}, {}, {{Eigen::VectorXd::Ones(kNumValues + 1), 0, .1}}});
    refuse({3, 8, {}, {}, {{Eigen::VectorXd::Ones(kNumValues), 0, 0}}});
    refuse({3, 8, {{Eigen::Vector3d::Zero(), MatrixRows::Zero(1, 3), {}, 1}}, {}, {}});
}

TEST(StoredEvidence, ComesBackInSinglePrecision) {
    FrameEstimate estimate = spoilt_estimates()[3];
    estimate.information +=
        .3 * Eigen::VectorXd::LinSpaced(kSize, 1, 2) * Eigen::VectorXd::LinSpaced(kSize, 1, 2).transpose();
    estimate.gradient = Eigen::VectorXd::LinSpaced(kSize, -1, 1);
    const FrameEstimate back =
        stored_estimate(estimate.camera_from_head, estimate.pose_cov(), estimate.values,
                        estimate.values_std(), pack_evidence(estimate), .8, false);
    EXPECT_LT((back.information - estimate.information).norm(), 1e-6 * estimate.information.norm());
    EXPECT_LT((back.gradient - estimate.gradient).norm(), 1e-6);
    EXPECT_LT((back.values_std() - estimate.values_std()).norm(), 1e-9);
    EXPECT_THROW(stored_estimate(estimate.camera_from_head, estimate.pose_cov(), Eigen::VectorXd::Zero(4),
                                 Eigen::VectorXd::Zero(4), pack_evidence(estimate), .8, false),
                 std::invalid_argument);
}

}  // namespace
}  // namespace mimetic
