// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdlib>
#include <mimetic/contact/contact.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Two horizontal squares 1 mm apart, one over the other, and two rims of three points beside them. Every
/// point is on a spring of its own.
class ContactTest : public testing::Test {
protected:
    static constexpr double kCompliance = 0.01;  // m/N

    void SetUp() override {
        rest.resize(14, 3);
        for (int level = 0; level < 2; ++level) {
            const double y = level == 0 ? 0.001 : 0;
            rest.middleRows(4 * level, 4) << 0, y, 0, 0.01, y, 0, 0.01, y, 0.01, 0, y, 0.01;
        }
        for (int i = 0; i < 3; ++i) {
            rest.row(8 + i) << 0.05 + 0.01 * i, 0.002, 0;
            rest.row(11 + i) << 0.05 + 0.01 * i, 0, 0;
        }
        response = ContactSolver::Response::Zero(14, 42);
        for (int i = 0; i < 14; ++i) {
            response(i, 3 * i + 1) = static_cast<float>(kCompliance);
        }
        Triangles triangles(4, 3);
        triangles << 0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6;  // the upper one faces down, the lower one up
        slits = {{{0, 1, 2, 3}, {4, 5, 6, 7}, triangles}, {{8, 9, 10}, {11, 12, 13}, Triangles(0, 3)}};
    }

    Points lowered(double by, int first, int count) const {
        Points displacements = Points::Zero(14, 3);
        displacements.block(first, 1, count, 1).setConstant(-by);
        return displacements;
    }

    Points rest;
    ContactSolver::Response response;
    std::vector<Slit> slits;
};

TEST_F(ContactTest, WhatDoesNotTouchIsLeftAlone) {
    const ContactSolver solver(rest, slits, response);
    EXPECT_EQ(solver.gaps(Points::Zero(14, 3)).size(), 0);
    EXPECT_TRUE(solver.solve(lowered(0.0009, 0, 4)).isZero(0));
}

TEST_F(ContactTest, BothSurfacesYieldByHalf) {
    const ContactSolver solver(rest, slits, response);
    const Points pressed = lowered(0.003, 0, 4);
    EXPECT_NEAR(solver.gaps(pressed).minCoeff(), -0.002, 1e-12);
    const Eigen::VectorXd forces = solver.solve(pressed);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(forces[i] * kCompliance, 0.001, 2e-5);
        EXPECT_NEAR(forces[i], -forces[i + 4], 1e-9);
    }
    EXPECT_TRUE(forces.tail(6).isZero(0));
}

TEST_F(ContactTest, LinesTouchBetweenTheirPointsToo) {
    const ContactSolver solver(rest, slits, response);
    Points pressed = lowered(0.004, 8, 3);
    pressed(8, 0) = 0.005;  // the first upper point stands between two lower ones
    const Eigen::VectorXd forces = solver.solve(pressed);
    Points parted = pressed;
    parted.col(1) += kCompliance * forces;
    EXPECT_GT(solver.gaps(parted).size() ? solver.gaps(parted).minCoeff() : 0, -3e-5);
    EXPECT_GT(forces.segment(8, 3).minCoeff(), 0);
    EXPECT_NEAR(forces.sum(), 0, 1e-9);
}

TEST_F(ContactTest, WhatLiesTooDeepComesFromElsewhere) {
    const ContactSolver solver(rest, slits, response);
    EXPECT_EQ(solver.gaps(lowered(0.020, 0, 4)).size(), 0);
}

TEST_F(ContactTest, WhatOverlapsAtRestMayStaySo) {
    rest.block(0, 1, 4, 1).setConstant(-0.0005);
    const ContactSolver solver(rest, slits, response);
    EXPECT_TRUE(solver.solve(Points::Zero(14, 3)).isZero(0));
    EXPECT_NEAR(solver.gaps(lowered(0.001, 0, 4)).minCoeff(), -0.001, 1e-12);
}

TEST_F(ContactTest, BadInputIsNamed) {
    slits[1].upper.push_back(14);
    EXPECT_THROW(ContactSolver(rest, slits, response), InvalidInput);
    EXPECT_THROW(ContactSolver(rest, {}, response.leftCols(41)), InvalidInput);
    ContactOptions options;
    options.relaxation = 2;
    EXPECT_THROW(ContactSolver(rest, {}, response, options), InvalidInput);
}

TEST(PartOverlaps, StopsAtTheExactSolutionOfTwo) {
    Eigen::Matrix2d compliance;
    compliance << 2, 1, 1, 2;
    ContactOptions options;
    options.softness = 1e-9;
    options.convergence = 1e-10;
    const Eigen::VectorXd both = part_overlaps(compliance, Eigen::Vector2d(-3, -3), options);
    EXPECT_NEAR(both[0], 1, 1e-6);
    EXPECT_NEAR(both[1], 1, 1e-6);
    const Eigen::VectorXd one = part_overlaps(compliance, Eigen::Vector2d(-2, 1), options);
    EXPECT_NEAR(one[0], 1, 1e-6);
    EXPECT_EQ(one[1], 0);
}

TEST(PartOverlaps, ForcesPushOnlyAndOnlyWhereThereIsContact) {
    std::srand(0);
    const Eigen::MatrixXd factor = Eigen::MatrixXd::Random(8, 8);
    const Eigen::MatrixXd compliance = factor * factor.transpose() + Eigen::MatrixXd::Identity(8, 8);
    const Eigen::VectorXd gaps = Eigen::VectorXd::Random(8);
    const Eigen::VectorXd forces = part_overlaps(compliance, gaps);
    const Eigen::VectorXd parted = compliance * forces + gaps;
    EXPECT_GE(forces.minCoeff(), 0);
    EXPECT_TRUE((forces.array() > 0).any());
    EXPECT_TRUE((forces.array() == 0).any());
    EXPECT_GT(parted.minCoeff(), -.02);
    EXPECT_LT((forces.array() > 0).select(parted, 0).cwiseAbs().maxCoeff(), .02);
}

}  // namespace
}  // namespace mimetic
