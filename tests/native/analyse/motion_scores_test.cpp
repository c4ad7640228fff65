// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/analyse/distinct_frames.hpp>
#include <mimetic/analyse/motion_scores.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

namespace mimetic {
namespace {

using Seen = Rows<std::uint8_t, Eigen::Dynamic>;

TEST(MotionScores, HalfTheMotionExplainsThreeQuarters) {
    Tracks tracks = Tracks::Zero(3, 4);
    tracks.row(1) << 4, 0, 0, 0;
    tracks.row(2) << 8, 0, 0, 0;
    const ImageScores scores = score_image_motion(tracks, 0 * tracks, Seen::Ones(3, 2), tracks / 2);
    EXPECT_NEAR(scores.explained, .75, 1e-12);
    EXPECT_NEAR(scores.moving_median_px, 3, 1e-12);
    EXPECT_NEAR(scores.median_px, 1, 1e-12);  // of 0, 0, 2 and 4
    EXPECT_NEAR(scores.beyond_head_rms_px, std::sqrt(80. / 4), 1e-12);
    Seen first = Seen::Zero(3, 2);
    first.row(0).setOnes();
    EXPECT_TRUE(std::isnan(score_image_motion(tracks, tracks, first, tracks).explained));
    EXPECT_THROW(score_image_motion(tracks, tracks, Seen::Ones(3, 3), tracks), InvalidInput);
}

TEST(MotionScores, HeadFramesThatAreTurnedDoNotCount) {
    Tracks points(2, 12);
    points.row(0) << 0, 0, 0, .1, 0, 0, 0, .1, 0, 0, 0, .05;
    points.row(1) = points.row(0).array() + .004;
    const Eigen::Matrix3d turn = rotation_from_vector({.2, -.1, .4});
    Tracks predicted = points;
    for (Eigen::Index i = 0; i < 2; ++i) {
        Eigen::Map<Points> row(predicted.row(i).data(), 4, 3);
        row = (row * turn).eval();
    }
    const SurfaceScores scores = score_surface_motion(points, Seen::Ones(2, 4), predicted);
    EXPECT_NEAR(scores.explained, 1, 1e-9);
    EXPECT_NEAR(scores.shape_median_mm, 0, 1e-9);
    EXPECT_NEAR(scores.moving_median_mm, 0, 1e-9);
}

TEST(MotionScores, ATurnTooFarIsAnErrorAboutItsAxis) {
    std::vector<Eigen::Isometry3d> truly(2, Eigen::Isometry3d::Identity()), poses = truly;
    truly[1].linear() = rotation_from_vector({0, .1, 0});
    poses[1].linear() = rotation_from_vector({0, .15, 0});
    const Points errors = head_turn_errors(truly, poses);
    EXPECT_TRUE(errors.row(0).isZero(1e-12));
    EXPECT_TRUE(errors.row(1).isApprox(Eigen::RowVector3d(0, .05 * 180 / std::acos(-1), 0), 1e-9));
}

TEST(DistinctRows, TheFarthestComesNextAndWhatIsNotUsableNever) {
    MatrixRows table(5, 1);
    table << 0, 1, 2, 9, 10;
    EXPECT_EQ(distinct_rows(table, {true, true, true, true, false}, 1, 2), std::vector<int>({1, 3}));
    EXPECT_EQ(distinct_rows(table, {true, true, true, true, false}, 1, 9), std::vector<int>({0, 1, 2, 3}));
    EXPECT_THROW(distinct_rows(table, {true}, 0, 2), InvalidInput);
}

}  // namespace
}  // namespace mimetic
