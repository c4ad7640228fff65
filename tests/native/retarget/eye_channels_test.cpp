// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/retarget/eye_channels.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kDistance = 25;  // of what eyes look at
const Eigen::RowVector3d kLeft{0, 0, 1}, kUp{-1, 0, 0};
const Eigen::Vector3d kAhead{0, -1, 0};

EyeChannel aim(int bone, const Eigen::RowVector3d& way, const std::vector<int>& eyes) {
    EyeTurns turned = EyeTurns::Zero();
    for (const int eye : eyes) turned.row(eye) = 2 * std::atan(2 / kDistance) * way;
    return {bone, true, eye_rates(turned, true, 2)};
}

MatrixRows both_turn(double yaw, double pitch, double other_yaw) {
    const Points left = gaze_turns(Eigen::VectorXd::Constant(1, yaw), Eigen::VectorXd::Constant(1, pitch));
    const Points right =
        gaze_turns(Eigen::VectorXd::Constant(1, other_yaw), Eigen::VectorXd::Constant(1, pitch));
    MatrixRows turns(1, 6);
    turns << left, right;
    return turns;
}

TEST(EyeChannels, AGazeTurnsTheShortestWay) {
    const Points turns = gaze_turns(Eigen::VectorXd::Constant(1, 30), Eigen::VectorXd::Constant(1, 20));
    const Eigen::Vector3d vector = turns.row(0);
    const Eigen::Vector3d seen = Eigen::AngleAxisd(vector.norm(), vector.normalized()) * kAhead;
    const double yaw = 30 * EIGEN_PI / 180, pitch = 20 * EIGEN_PI / 180;
    const Eigen::Vector3d wanted{std::sin(yaw) * std::cos(pitch), -std::cos(yaw) * std::cos(pitch),
                                 std::sin(pitch)};
    EXPECT_LT((seen - wanted).norm(), 1e-12);
    EXPECT_NEAR(vector.dot(kAhead), 0, 1e-12);
}

TEST(EyeChannels, EachEyeLooksAtItsOwnBoneAndTheCommonOneRests) {
    const EyeChannels channels({aim(0, kLeft, {0, 1}), aim(0, kUp, {0, 1}), aim(1, kLeft, {0}),
                                aim(1, kUp, {0}), aim(2, kLeft, {1}), aim(2, kUp, {1})},
                               kAhead, {0, 1});
    const MatrixRows values = channels.values(both_turn(25, 10, -15));
    EXPECT_EQ(values(0, 0), 0);
    EXPECT_EQ(values(0, 1), 0);
    const auto looks = [](double x, double z) { return Eigen::Vector3d{x, -kDistance, z}.normalized(); };
    const auto wanted = [](double yaw, double pitch) {
        yaw *= EIGEN_PI / 180, pitch *= EIGEN_PI / 180;
        return Eigen::Vector3d{std::sin(yaw) * std::cos(pitch), -std::cos(yaw) * std::cos(pitch),
                               std::sin(pitch)};
    };
    EXPECT_LT((looks(values(0, 2), values(0, 3)) - wanted(25, 10)).norm(), 1e-9);
    EXPECT_LT((looks(values(0, 4), values(0, 5)) - wanted(-15, 10)).norm(), 1e-9);
    EXPECT_TRUE(channels.undriven().empty());
}

TEST(EyeChannels, ACommonBoneStandsInForAnEyeWithoutItsOwn) {
    const EyeChannels channels({aim(0, kLeft, {0, 1}), aim(0, kUp, {0, 1}), aim(1, kLeft, {0})}, kAhead,
                               {0, 1});
    const MatrixRows values = channels.values(both_turn(20, 0, 20));
    EXPECT_NEAR(values(0, 0), kDistance * std::tan(20 * EIGEN_PI / 180), 1e-9);
    EXPECT_EQ(values(0, 2), 0);
}

TEST(EyeChannels, TurnsAboutAxesThatLieAnyhowAddUpToTheGaze) {
    const Eigen::Matrix3d axes =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d{1, 2, -1}.normalized()).toRotationMatrix();
    std::vector<EyeChannel> turning;
    for (int axis = 0; axis < 3; ++axis) {
        EyeTurns turned = EyeTurns::Zero();
        turned.row(0) = .3 * axes.col(axis).transpose();
        turning.push_back({0, false, eye_rates(turned, false, 1)});
    }
    const EyeChannels channels(turning, kAhead, {0});
    const MatrixRows turns = both_turn(-20, 15, 0);
    const MatrixRows values = channels.values(turns);
    const Eigen::Vector3d made = .15 * axes * values.row(0).transpose();
    EXPECT_LT((made - turns.row(0).head(3).transpose()).norm(), 1e-12);
}

TEST(EyeChannels, AnEyeThatNothingTurnsIsNamed) {
    const EyeChannels channels({aim(1, kLeft, {0})}, kAhead, {0, 1});
    EXPECT_EQ(channels.undriven(), std::vector<int>{1});
    EXPECT_THROW(EyeChannels({}, kAhead, {2}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
