// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/solve/face_state.hpp"

#include <gtest/gtest.h>

namespace mimetic {
namespace {

FaceState turned_state() {
    FaceState state;
    state.camera_from_head.linear() =
        (Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(.3, Eigen::Vector3d::UnitY()))
            .toRotationMatrix();
    state.camera_from_head.translation() = Eigen::Vector3d(.02, -.03, .6);
    state.values = Eigen::Vector3d(.2, .5, -.1);
    return state;
}

TEST(FaceState, SkinJacobianMeetsFiniteDifferences) {
    const Camera camera{600, 610, 320, 240, 640, 480};
    const FaceState state = turned_state();
    SkinPoint skin{Eigen::Vector3f(.03f, .05f, .09f), Eigen::Matrix3Xf(3, 3), {}};
    skin.modes << .01f, 0, .002f, .004f, -.01f, 0, 0, .003f, .008f;
    Eigen::Matrix<float, 2, Eigen::Dynamic> jacobian;
    Eigen::Matrix<double, 2, 3> by_point;
    const Eigen::Vector3f point_in_head = skin.neutral + skin.modes * state.values.cast<float>();
    skin_jacobian(camera, state.camera_from_head, point_in_head.cast<double>(), skin.modes, jacobian,
                  by_point);
    const auto project = [&](const Eigen::VectorXd& step) {
        FaceState moved = state;
        moved.apply(FaceStep(step));
        const Eigen::Vector3d point = skin.neutral.cast<double>() + skin.modes.cast<double>() * moved.values;
        return camera.project(moved.camera_from_head * point);
    };
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 9; ++i) {
        const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(9, i);
        const Eigen::Vector2d difference = (project(step) - project(-step)) / (2 * kStep);
        EXPECT_LT((difference - jacobian.col(i).cast<double>()).norm(), 1e-3 * (1 + difference.norm())) << i;
    }
}

TEST(FaceState, DifferenceUndoesApply) {
    const FaceState state = turned_state();
    FaceState moved = state;
    FaceStep step = FaceStep::none(3);
    step.rotation() << .1, -.2, .05;
    step.translation() << .01, .02, -.03;
    step.values() << .1, -.2, .3;
    moved.apply(step);
    EXPECT_LT((moved.difference_from(state).flat - step.flat).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(step.flat[4], .02);
    EXPECT_DOUBLE_EQ(step.flat[6], .1);
}

}  // namespace
}  // namespace mimetic
