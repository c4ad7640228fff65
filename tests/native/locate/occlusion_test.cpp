// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/shared/error.hpp>
#include <utility>

namespace mimetic {
namespace {

constexpr int kSide = OcclusionNetwork::kCells;

/// The right half of a square of 240 pixels about (200, 100) is covered.
Occlusion right_half(double roll) {
    Occlusion seen{{{200, 100}, 240, roll}, Eigen::MatrixXf::Zero(kSide, kSide)};
    seen.cells.rightCols(kSide / 2).setOnes();
    return seen;
}

TEST(Occlusion, IsReadBetweenTheMiddlesOfCells) {
    const Occlusion seen = right_half(0);
    EXPECT_EQ(seen.at({140, 60}), 0);
    EXPECT_EQ(seen.at({260, 150}), 1);
    EXPECT_NEAR(seen.at({200, 100}), .5, 1e-6);
    EXPECT_NEAR(seen.at({202.5, 180}), .75, 1e-6);
    EXPECT_EQ(seen.at({319, 219}), 1) << "the outer half of a cell at the edge is as its middle";
}

TEST(Occlusion, IsNoneBesideTheSquareAndWhereNobodyLooked) {
    const Occlusion seen = right_half(0);
    for (const auto& [x, y] : {std::pair(321., 100.), {200., -21.}, {200., 221.}, {NAN, 100.}}) {
        EXPECT_EQ(seen.at({x, y}), 0);
    }
    EXPECT_EQ(Occlusion{}.at({200, 100}), 0);
    EXPECT_EQ(Occlusion{}.share(), 0);
}

TEST(Occlusion, TurnsWithTheSquare) {
    const Occlusion seen = right_half(M_PI / 2);  // what was to the right is below
    EXPECT_EQ(seen.at({200, 160}), 1);
    EXPECT_EQ(seen.at({200, 40}), 0);
    EXPECT_NEAR(seen.at({290, 100}), .5, 1e-6);
}

TEST(Occlusion, SaysWhereItsCellsAre) {
    const Occlusion seen = right_half(.3);
    for (const auto& [row, column] : {std::pair(0., 0.), {5., 18.}, {11.5, 11.5}}) {
        const Eigen::Vector2d pixel = seen.pixel_of(row, column);
        EXPECT_NEAR(seen.at(pixel), std::clamp(column - 11, 0., 1.), 1e-6);
    }
    EXPECT_LT((seen.pixel_of(11.5, 11.5) - seen.square.center).norm(), 1e-9);
    EXPECT_LT((right_half(0).pixel_of(0, 23) - Eigen::Vector2d(315, -15)).norm(), 1e-9);
}

TEST(Occlusion, TellsTheShareOfAFace) {
    EXPECT_NEAR(right_half(0).share(), .5, 1e-9);
    Occlusion perhaps = right_half(0);
    EXPECT_TRUE(perhaps.is_sure());
    perhaps.cells *= .8F;
    EXPECT_FALSE(perhaps.is_sure());
    EXPECT_NEAR(perhaps.share(), .5, 1e-9);
    Occlusion corners = right_half(0);
    corners.cells.setZero();
    corners.cells.topLeftCorner(4, 4).setOnes();
    EXPECT_EQ(corners.share(), 0) << "no face reaches the corners of its square";
}

TEST(OcclusionNetwork, RefusesAFileThatIsNone) {
    EXPECT_THROW(OcclusionNetwork("nowhere.onnx"), UnreadableMedia);
}

TEST(OcclusionNetwork, LooksWhereTheHeadIs) {
    const Camera camera{900, 900, 319.5, 239.5, 640, 480};
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    pose.translation() = Eigen::Vector3d(.1, 0, .7);
    const FeatureCrop square = occlusion_square(camera, pose);
    EXPECT_GT(square.center.x(), camera.cx + 100);
    EXPECT_NEAR(square.side, .19 * camera.fx / (.7 - .08), 1);
    pose.translation().z() = -.7;
    EXPECT_THROW(occlusion_square(camera, pose), InvalidInput);
}

}  // namespace
}  // namespace mimetic
