// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/evidence.hpp>

namespace mimetic {
namespace {

TEST(Evidence, IsThatOfTheNormalDistribution) {
    std::srand(1);
    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(9, 6);  // two shares of 3 values
    const Eigen::VectorXd displacement = Eigen::VectorXd::Random(9);
    const Eigen::Vector3d std(.5, .2, 1), strength(.1, 0, -.2);
    MatrixRows shares(2, 3);
    shares << 1, 1, 1, .3, -.2, .5;
    const LinearFrame frame(columns, displacement, {0, 1, 2}, std);
    const Eigen::MatrixXd modes = (columns.leftCols(3) + columns.rightCols(3) * shares.row(1).asDiagonal()) *
                                  Eigen::Vector3d(strength.array().exp() * std.array()).asDiagonal();
    const Eigen::MatrixXd spread = Eigen::MatrixXd::Identity(9, 9) + modes * modes.transpose();
    const double expected = .5 * displacement.squaredNorm() -
                            .5 * displacement.dot(spread.inverse() * displacement) -
                            .5 * std::log(spread.determinant());
    EXPECT_NEAR(frame.log_evidence(shares, strength), expected, 1e-12);
}

TEST(Evidence, TheMaximumIsFoundWithItsWidth) {
    const auto hill = [](const Eigen::VectorXd& place) {
        return -2 * std::pow(place[0] - .3, 2) - .5 * std::pow(place[1] + 5, 2);
    };
    const Peak peak = maximise(hill, Eigen::Vector2d::Zero(), .4);
    EXPECT_LT((peak.place - Eigen::Vector2d(.3, -.4)).norm(), 1e-3);  // the second at its bound
    EXPECT_NEAR(peak.std[0], .5, 1e-3);
    EXPECT_NEAR(peak.std[1], 1, 1e-3);
}

TEST(Evidence, ClimbsOutOfAHollow) {
    const auto hollow = [](const Eigen::VectorXd& place) { return std::cos(8 * (place[0] - .5)); };
    const Peak peak = maximise(hollow, Eigen::VectorXd::Constant(1, .05), .9);
    EXPECT_GT(peak.height, .999);
}

TEST(Evidence, StopsWhenToldAndKeepsTheBestPlace) {
    int num_calls = 0;
    const auto hill = [](const Eigen::VectorXd& place) { return -std::pow(place[0] - .3, 4); };
    const Peak peak = maximise(hill, Eigen::VectorXd::Zero(1), .4, [&](double) { return ++num_calls < 3; });
    EXPECT_EQ(num_calls, 3);
    EXPECT_GT(peak.height, hill(Eigen::VectorXd::Zero(1)));
}

TEST(Evidence, StrengthsAndStiffnessChangeWhatTheyShould) {
    // One value whose mode is twice as strong as assumed, and one region that changes nothing
    Eigen::MatrixXd columns =
        Eigen::MatrixXd::Zero(40, 4);  // modes, by stiffness, by insertion outwards and up
    columns.col(0).setConstant(3);
    const LinearFrame frame(columns, Eigen::VectorXd::Constant(40, 6), {0}, Eigen::VectorXd::Constant(1, .5));
    SkinFactors factors{1, {0}, 1};
    const SkinEvidence evidence({frame}, factors, Eigen::VectorXd::Zero(factors.size()));
    const Peak peak = maximise([&](const Eigen::VectorXd& p) { return evidence.log_probability(p); },
                               Eigen::VectorXd::Zero(factors.size()), .4);
    EXPECT_GT(peak.place[1], .03);
    EXPECT_NEAR(peak.place[0], 0, 1e-9);
    EXPECT_NEAR(peak.std[0], factors.stiffness_std, 1e-3);
    EXPECT_THROW(SkinEvidence({frame}, factors, Eigen::VectorXd::Zero(2)), InvalidInput);
    factors.num_regions = 2;
    EXPECT_THROW(SkinEvidence({frame}, factors, Eigen::VectorXd::Zero(factors.size())), InvalidInput);
}

}  // namespace
}  // namespace mimetic
