// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/surface/face_lines.hpp>
#include <mimetic/surface/surface.hpp>

namespace mimetic {
namespace {

const Camera kCamera{100, 100, 49.5, 39.5, 100, 80};

/// A square that faces a camera at the origin, its y up in the picture; counter-clockwise seen from there.
Points square(double half, double z) {
    Points points(4, 3);
    points << -half, half, z, half, half, z, half, -half, z, -half, -half, z;
    return points;
}

const Quads kOne = (Quads(1, 4) << 0, 1, 2, 3).finished();
const Quads kTwo = (Quads(2, 4) << 0, 1, 2, 3, 4, 5, 6, 7).finished();

MatrixRows no_modes(Eigen::Index vertices) { return MatrixRows::Zero(1, 3 * vertices); }

TEST(QuadEdges, EveryEdgeComesOnceWithItsFaces) {
    const Quads faces = (Quads(2, 4) << 0, 1, 2, 3, 1, 4, 5, 2).finished();
    const QuadEdges mesh(faces, 6);
    ASSERT_EQ(mesh.edges().size(), 7U);
    for (const QuadEdges::Edge& edge : mesh.edges()) {
        const bool is_shared = edge.first == 1 && edge.second == 2;
        EXPECT_EQ(edge.faces[1] >= 0, is_shared);
    }
    EXPECT_THROW(QuadEdges(faces, 5), InvalidInput);
}

TEST(FaceLines, ASquareIsDrawnWhereItsLimitIs) {
    const Points neutral = square(.2, 1);
    const FaceLines lines(kCamera, neutral, no_modes(4), kOne, {{true}, {{0, 1}}, {0}});
    const DrawnLines drawn = lines.draw(Eigen::VectorXd::Zero(1), Eigen::Isometry3d::Identity());
    EXPECT_EQ(drawn.mesh.rows(), 8);  // four edges
    EXPECT_EQ(drawn.features.rows(), 2);
    ASSERT_TRUE(drawn.marks_shown[0]);
    // From the centres of pixels, y down, to parts of the picture, y up
    const Eigen::Vector3d corner = SubdividedMesh(kOne, 4, 0).positions(neutral).row(0);
    const Eigen::Vector2d pixel = kCamera.project(corner);
    EXPECT_NEAR(drawn.marks(0, 0), (pixel.x() + .5) / 100, 1e-6);
    EXPECT_NEAR(drawn.marks(0, 1), 1 - (pixel.y() + .5) / 80, 1e-6);
}

TEST(FaceLines, ModesMoveWhatIsDrawn) {
    MatrixRows modes = no_modes(4);
    for (int v = 0; v < 4; ++v) {
        modes(0, 3 * v) = .1;
    }
    const FaceLines lines(kCamera, square(.2, 1), modes, kOne, {{true}, {}, {0}});
    const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
    const float rest = lines.draw(Eigen::VectorXd::Zero(1), still).marks(0, 0);
    const float moved = lines.draw(Eigen::VectorXd::Constant(1, 2), still).marks(0, 0);
    EXPECT_NEAR(moved - rest, 2 * .1 * 100 / 100, 1e-6);
    EXPECT_THROW(lines.draw(Eigen::VectorXd::Zero(2), still), InvalidInput);
}

TEST(FaceLines, WhatACoveringFaceHidesIsLeftOut) {
    Points both(8, 3);
    both << square(.2, 1), square(.1, 1.2);  // the smaller one lies behind
    const FaceLines lines(kCamera, both, no_modes(8), kTwo, {{true, true}, {{4, 5}}, {4, 0}});
    const DrawnLines drawn = lines.draw(Eigen::VectorXd::Zero(1), Eigen::Isometry3d::Identity());
    EXPECT_EQ(drawn.mesh.rows(), 8);
    EXPECT_EQ(drawn.features.rows(), 0);
    EXPECT_FALSE(drawn.marks_shown[0]);
    EXPECT_TRUE(drawn.marks_shown[1]);
    // A ring before the skin is drawn, closed; one behind it is not
    const Points ring = square(.05, .9), hidden = square(.05, 1.1);
    EXPECT_EQ(
        lines.draw(Eigen::VectorXd::Zero(1), Eigen::Isometry3d::Identity(), {ring, hidden}).rings.rows(), 8);
}

TEST(FaceLines, AFaceTurnedAwayOrBehindTheCameraIsNotDrawn) {
    const FaceLines lines(kCamera, square(.2, 1), no_modes(4), kOne, {{true}, {}, {0}});
    Eigen::Isometry3d behind = Eigen::Isometry3d::Identity();
    behind.translation().z() = -3;
    EXPECT_EQ(lines.draw(Eigen::VectorXd::Zero(1), behind).mesh.rows(), 0);
    Eigen::Isometry3d around = Eigen::Isometry3d::Identity();
    around.linear() = Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitY()).toRotationMatrix();
    around.translation().z() = 2;
    EXPECT_EQ(lines.draw(Eigen::VectorXd::Zero(1), around).mesh.rows(), 0);
}

TEST(FaceLines, RefusesWhatDoesNotFit) {
    const Points neutral = square(.2, 1);
    EXPECT_THROW(FaceLines(kCamera, neutral, no_modes(3), kOne, {{true}, {}, {}}), InvalidInput);
    EXPECT_THROW(FaceLines(kCamera, neutral, no_modes(4), kOne, {{}, {}, {}}), InvalidInput);
    EXPECT_THROW(FaceLines(kCamera, neutral, no_modes(4), kOne, {{true}, {{4}}, {}}), InvalidInput);
    EXPECT_THROW(FaceLines(kCamera, neutral, no_modes(4), kOne, {{true}, {}, {-1}}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
