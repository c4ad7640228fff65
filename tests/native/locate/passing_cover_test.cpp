// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/passing_cover.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kSide = OcclusionNetwork::kCells;
constexpr double kCell = 10;  // pixels

/// A head that has gone right by cells, behind something in the picture's columns from 10 to 13, cells.
Occlusion behind_a_stand(int right, float probability) {
    Occlusion seen{{{200 + kCell * right, 100}, kCell * kSide, 0}, Eigen::MatrixXf::Zero(kSide, kSide)};
    seen.cells.middleCols(10 - right, 4).setConstant(probability);
    return seen;
}

TEST(PassingCover, IsNotWhatStaysInThePictureWhileTheHeadMoves) {
    std::vector<Occlusion> frames;
    for (int right = -3; right <= 3; ++right) {
        frames.push_back(behind_a_stand(right, right % 2 == 0 ? .95F : .7F));
    }
    const Eigen::VectorXd shares = passing_shares(frames);
    EXPECT_GT(frames[1].sure_share(), .1);
    EXPECT_EQ(shares.size(), 7);
    EXPECT_EQ(shares.maxCoeff(), 0);
}

TEST(PassingCover, IsAHandBeforeHalfOfTheFrames) {
    std::vector<Occlusion> frames;
    for (int frame = 0; frame < 10; ++frame) {
        frames.push_back(behind_a_stand(0, frame < 5 ? .02F : .97F));
    }
    const Eigen::VectorXd shares = passing_shares(frames);
    EXPECT_EQ(shares.head(5).maxCoeff(), 0);
    EXPECT_EQ(shares[7], frames[7].sure_share());
    EXPECT_GT(shares.tail(5).minCoeff(), .1);
}

TEST(PassingCover, GoesWithTheHeadForWhatTheHeadCarries) {
    std::vector<Occlusion> frames;  // far from each other, with the same cells of the face hidden
    for (int frame = 0; frame < 6; ++frame) {
        frames.push_back(behind_a_stand(0, .97F));
        frames.back().square.center.x() += 60. * frame;
    }
    EXPECT_GT(passing_shares(frames).minCoeff(), .1);
}

TEST(PassingCover, NeedsFramesAtWhichANetworkHasLooked) {
    EXPECT_EQ(passing_shares({}).size(), 0);
    EXPECT_THROW(passing_shares({behind_a_stand(0, 1), Occlusion{}}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
