// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/head/rig_motion.hpp>
#include <mimetic/shared/covariance.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/similarity.hpp>

namespace mimetic {
namespace {

Eigen::Isometry3d pose(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = rotation_from_vector(turn);
    result.translation() = shift;
    return result;
}

/// World from a parent that is turned, twice as large and mirrored along one of its axes.
Eigen::Affine3d mirrored(int axis) {
    Eigen::Vector3d scales = Eigen::Vector3d::Constant(2);
    scales[axis] = -2;
    Eigen::Affine3d result = Eigen::Affine3d::Identity();
    result.linear() = rotation_from_vector({.3, -.2, .7}) * scales.asDiagonal();
    result.translation() = Eigen::Vector3d(1, 2, 3);
    return result;
}

TEST(RigMotion, HeadAndNeckTogetherTurnAsTheHead) {
    const RigidMotion moved{{rotation_from_vector({.1, .2, .3})}, Points::Constant(1, 3, .01)};
    BoneAxes bones{rotation_from_vector({1, 0, 0}),
                   rotation_from_vector({0, .5, 0}),
                   rotation_from_vector({0, 0, .7}),
                   .4,
                   1,
                   true,
                   2};
    const BoneMotion motion = bone_motion(moved, bones);
    const Eigen::Matrix3d neck = *bones.neck_rest * motion.neck[0] * bones.neck_rest->transpose();
    const Eigen::Matrix3d head = bones.head_rest * motion.head.rotations[0] * bones.head_rest.transpose();
    const Eigen::Matrix3d whole = bones.axes * moved.rotations[0] * bones.axes.transpose();
    EXPECT_TRUE((neck * head).isApprox(whole, 1e-12));
    EXPECT_NEAR(motion.head.shifts.norm(), 2 * moved.shifts.norm(), 1e-12);
}

TEST(RigMotion, APointFixedToTheHeadIsStillAtRest) {
    const std::vector<Eigen::Isometry3d> poses{pose({0, .1, 0}, {0, 0, .6}), pose({0, .3, 0}, {.1, 0, .6})};
    const RigidMotion moved = motion_from_rest(poses, 0, false, {0, -.1, 0});
    EXPECT_TRUE(moved.rotations[0].isIdentity(1e-12));
    EXPECT_TRUE(moved.shifts.row(0).isZero(1e-12));
    EXPECT_TRUE(moved.rotations[1].isApprox(rotation_from_vector({0, .2, 0}), 1e-12));
}

TEST(RigMotion, AxesDoNotJumpWhereATurnGoesThroughRest) {
    const Rotations turns{rotation_from_vector({0, 0, .2}), Eigen::Matrix3d::Identity(),
                          rotation_from_vector({0, 0, -.2})};
    const Rows<double, 4> angles = axis_angles(turns);
    EXPECT_NEAR(angles(0, 0), .2, 1e-12);
    EXPECT_NEAR(angles(2, 0), -.2, 1e-12);
    EXPECT_TRUE(angles.rightCols(3).isApprox(Eigen::RowVector3d(0, 0, 1).replicate(3, 1), 1e-9));
}

TEST(RigMotion, FlatParentsAndCamerasAreRefused) {
    Eigen::Matrix4d flat = Eigen::Matrix4d::Identity();
    flat.col(1).setZero();
    const RigidMotion still{{Eigen::Matrix3d::Identity()}, Points::Zero(1, 3)};
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    EXPECT_THROW(carry_object(still, {0, 0, 0}, one, flat, one, 1), InvalidInput);
    EXPECT_THROW(place_object({Eigen::Isometry3d::Identity()}, {0, 0, 0}, flat, one, 1), InvalidInput);
    EXPECT_THROW(world_from_object({Eigen::Isometry3d::Identity()}, flat), InvalidInput);
}

TEST(RigMotion, UnderAMirroredParentAHeadStaysUprightBeforeTheCamera) {
    const Eigen::Matrix3d axes = rotation_from_vector({0, 0, 1});
    const Eigen::Isometry3d head = pose({.1, .4, .2}, {.1, .2, -.5});
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Affine3d parent = mirrored(axis);
        const RigidMotion placed = place_object({head}, {0, 0, 0}, parent.matrix(), axes, 1);
        const Eigen::Matrix3d world = parent.linear() * placed.rotations[0] * axes / 2;
        EXPECT_TRUE(world.rightCols(2).isApprox(head.linear().rightCols(2), 1e-12));
        EXPECT_TRUE(world.col(0).isApprox(-head.linear().col(0), 1e-12));
        EXPECT_NEAR(placed.rotations[0].determinant(), 1, 1e-12);
        const Eigen::Vector3d shift = placed.shifts.row(0).transpose();
        EXPECT_TRUE((parent * shift).isApprox(head.translation(), 1e-12));
    }
}

TEST(RigMotion, UnderAMirroredParentAnObjectTurnsAsTheHeadDoes) {
    const RigidMotion moved{{rotation_from_vector({.1, .4, .2})}, Points::Constant(1, 3, .01)};
    const Eigen::Matrix3d rotation = rotation_from_vector({0, .5, 0});
    const Eigen::Matrix3d axes = rotation_from_vector({0, 0, 1});
    const Eigen::Matrix3d turn = axes * moved.rotations[0] * axes.transpose();
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Affine3d parent = mirrored(axis);
        const RigidMotion carried = carry_object(moved, {1, 2, 3}, rotation, parent.matrix(), axes, 1);
        const Eigen::Matrix3d world = parent.linear() * carried.rotations[0];
        EXPECT_TRUE(world.isApprox(turn * parent.linear() * rotation, 1e-12));
    }
}

TEST(RigMotion, StillPointsKeepTheirDistanceWhenTheHeadNods) {
    Eigen::Matrix3d intrinsics;
    intrinsics << 500, 0, 320, 0, 500, 240, 0, 0, 1;
    const Eigen::Vector3d facing(3.14159265358979, 0, 0);
    const auto points =
        still_points({pose(facing, {0, 0, .6}), pose(.9 * facing, {0, 0, .6})}, intrinsics, 480);
    for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR((points.row(i).tail(2) - points.row(i).head(2)).norm(), 120, 6);
        EXPECT_LT(points(i, 3), points(i, 1));
    }
}

TEST(Covariance, WhatIsNotSymmetricOrVariesWithoutVarianceIsNone) {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(6, 6);
    EXPECT_TRUE(is_covariance(covariance, 1e-6));
    covariance(0, 1) = .1;
    EXPECT_TRUE(is_covariance(covariance));
    EXPECT_FALSE(is_covariance(covariance, 1e-6));
    covariance(1, 0) = .1;
    EXPECT_TRUE(is_covariance(covariance, 1e-6));
    covariance(0, 0) = 0;
    EXPECT_FALSE(is_covariance(covariance, 1e-6));
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    EXPECT_TRUE(is_rigid(matrix, 1e-4));
    matrix(0, 0) = -1;
    EXPECT_FALSE(is_rigid(matrix, 1e-4));
}

}  // namespace
}  // namespace mimetic
