// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/puppet/stillness.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

using namespace mimetic;

namespace {

constexpr double kFrame = 1. / 30;

LivePose pose_of(double turn, double value) {
    LivePose pose;
    pose.camera_from_head.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix() *
                                     Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal());
    pose.camera_from_head.translation() << 0, 0, .6;
    pose.values = Eigen::VectorXd::Constant(2, value);
    return pose;
}

TEST(Stillness, ZeroIsNoFilter) {
    StillnessFilter filter(0);
    std::mt19937 random(1);
    std::normal_distribution<double> jitter(0, .1);
    for (int frame = 0; frame < 20; ++frame) {
        const LivePose measured = pose_of(jitter(random), jitter(random));
        const LivePose now = filter.advance(measured, kFrame);
        EXPECT_LT((now.values - measured.values).norm(), 1e-12);
        EXPECT_LT((now.camera_from_head.matrix() - measured.camera_from_head.matrix()).norm(), 1e-9);
    }
}

TEST(Stillness, LessJitterCostsMoreLag) {
    StillnessFigures before = stillness_figures(0, 30);
    EXPECT_EQ(before.jitter_share, 1);
    EXPECT_NEAR(before.lag_frames, 0, 1e-9);
    for (const double stillness : {.25, .5, .75, 1.}) {
        const StillnessFigures now = stillness_figures(stillness, 30);
        EXPECT_LT(now.jitter_share, before.jitter_share - .05);
        EXPECT_GT(now.lag_frames, before.lag_frames + .02);
        before = now;
    }
    EXPECT_LT(before.jitter_share, .3);
    EXPECT_LT(before.lag_frames, 1);
}

TEST(Stillness, AHeadThatTurnsPastFacingTheCameraKeepsARotation) {
    StillnessFilter filter(1);
    double turn = -.6;
    LivePose now;
    for (int frame = 0; frame < 120; ++frame) {
        turn = std::min(.6, turn + .02);
        now = filter.advance(pose_of(turn, 0), kFrame);
        const Eigen::Matrix3d linear = now.camera_from_head.linear();
        EXPECT_LT((linear * linear.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
        EXPECT_GT(linear.determinant(), 0);
    }
    EXPECT_LT((now.camera_from_head.linear() - pose_of(.6, 0).camera_from_head.linear()).norm(), .02);
}

TEST(Stillness, ABlinkIsNotWornDown) {
    StillnessFilter filter(.5);
    double highest = 0;
    for (const double closure : {0., 0., 0., .5, 1., 1., .6, .2, 0., 0.}) {
        highest = std::max(highest, filter.advance(pose_of(0, closure), kFrame).values[0]);
    }
    EXPECT_GT(highest, .9);
}

TEST(Stillness, NothingIsDraggedAcrossAGap) {
    StillnessFilter filter(1);
    filter.advance(pose_of(0, 0), kFrame);
    filter.advance(pose_of(0, 0), kFrame);
    EXPECT_EQ(filter.advance(pose_of(.5, 1), 3).values[0], 1);
}

TEST(Stillness, WhatIsNoMotionIsRefused) {
    EXPECT_THROW(StillnessFilter(1.5), InvalidInput);
    EXPECT_THROW(StillnessFilter(std::nan("")), InvalidInput);
    EXPECT_THROW(stillness_figures(.5, 0), InvalidInput);
    StillnessFilter filter(.5);
    EXPECT_THROW(filter.set_stillness(-1), InvalidInput);
    EXPECT_THROW(filter.advance(pose_of(0, std::nan("")), kFrame), InvalidInput);
    EXPECT_THROW(filter.advance(pose_of(0, 0), std::nan("")), InvalidInput);
}

}  // namespace
