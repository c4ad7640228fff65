// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

const Camera kCamera{600, 610, 319.5, 239.5, 640, 480};

TEST(Camera, JacobianMeetsFiniteDifferences) {
    const Eigen::Vector3d point(0.05, -0.03, 0.7);
    const auto jacobian = kCamera.project_jacobian(point);
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d offset = kStep * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d difference =
            (kCamera.project(point + offset) - kCamera.project(point - offset)) / (2 * kStep);
        EXPECT_LT((difference - jacobian.col(axis)).norm(), 1e-4);
    }
}

TEST(Camera, RejectsFocalLengthOfZero) {
    Camera camera = kCamera;
    camera.fx = 0;
    EXPECT_THROW(camera.check(), InvalidInput);
}

TEST(Camera, RejectsAnImageOfTenPixels) {
    Camera camera = kCamera;
    camera.width = 10;
    EXPECT_THROW(camera.check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
