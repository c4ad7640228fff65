// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/analyse/composition.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kRows = 31;  // a second, 30 frames a second

/// A rise and fall in one column of two.
ExpressionPart bump(int column, double height, double start, double length = 1) {
    ExpressionPart part;
    part.values = MatrixRows::Zero(kRows, 2);
    for (int i = 0; i < kRows; ++i) {
        part.values(i, column) = height * std::pow(std::sin(M_PI * i / (kRows - 1)), 2);
    }
    part.stds = MatrixRows::Constant(kRows, 2, .02);
    part.start = start;
    part.length = length;
    return part;
}

Eigen::VectorXd seconds(double last, int count) { return Eigen::VectorXd::LinSpaced(count, 0, last); }

TEST(Composition, OneExpressionPlaysAsItIs) {
    const ExpressionPart part = bump(0, .8, 0);
    const Composition composed = compose_expressions({part}, seconds(1, kRows));
    EXPECT_TRUE(composed.values.isApprox(part.values, 1e-12));
    EXPECT_TRUE(composed.stds.isApprox(part.stds, 1e-12));
}

TEST(Composition, ExpressionsInDifferentMusclesDoNotWeakenEachOther) {
    ExpressionPart smile = bump(0, .8, 0), brows = bump(1, .6, .2);
    smile.values.col(1) = .03 * smile.values.col(0);  // what a capture leaves in idle muscles
    const Composition composed = compose_expressions({smile, brows}, seconds(1.2, 37));
    EXPECT_NEAR(composed.values.col(0).maxCoeff(), .8, 1e-3);
    EXPECT_NEAR(composed.values.col(1).maxCoeff(), .6, .01);
}

TEST(Composition, InOneMuscleTheNearerExpressionPrevailsAndNothingAddsUp) {
    const ExpressionPart one = bump(0, .8, 0), other = bump(0, .8, .5);
    const Composition composed = compose_expressions({one, other}, seconds(1.5, 151));
    EXPECT_LE(composed.values.maxCoeff(), .8 + 1e-9);
    EXPECT_NEAR(composed.values(50, 0), .8, .04);  // at its own peak the other has a say of 4 %
    EXPECT_NEAR(composed.values(100, 0), .8, .04);
    EXPECT_NEAR(composed.values(75, 0), .4, .02);  // half-way they have the same say: sin^2 there is a half
    for (Eigen::Index i = 1; i < composed.values.rows(); ++i) {
        EXPECT_LT(std::abs(composed.values(i, 0) - composed.values(i - 1, 0)), .05);
    }
}

TEST(Composition, StrengthLengthAndDominanceAreHeeded) {
    ExpressionPart part = bump(0, .4, .5, 2);
    part.strength = 2;
    const Composition composed = compose_expressions({part}, seconds(3, 301));
    Eigen::Index row = 0;
    EXPECT_NEAR(composed.values.col(0).maxCoeff(&row), .8, 1e-3);
    EXPECT_NEAR(.01 * static_cast<double>(row), 1.5, .02);
    EXPECT_NEAR(composed.stds(150, 0), .04, 1e-9);
    ExpressionPart other = bump(0, .8, 1, 1);
    part.dominance = 1e-6;
    const Composition yielding = compose_expressions({part, other}, seconds(3, 301));
    EXPECT_NEAR(yielding.values(110, 0), .8 * std::pow(std::sin(M_PI * .1), 2), .01);
}

TEST(Composition, WhatIsHeldIsNotGivenUpToAnExpressionThatLeavesTheMuscleAlone) {
    ExpressionPart smile = bump(0, .8, 0, 9), brows = bump(1, .6, 6, 2);
    smile.values.col(0).segment(8, kRows - 16).setConstant(.6);
    for (const double idle : {0., .01}) {
        brows.values.col(0).setConstant(idle);
        const Composition composed = compose_expressions({smile, brows}, seconds(9, 271));
        for (Eigen::Index i = 90; i < 180; ++i) {
            EXPECT_NEAR(composed.values(i, 0), .6, 1e-3);
        }
    }
}

TEST(Composition, FarFromAllExpressionsItRests) {
    const Composition composed = compose_expressions({bump(0, .8, 0), bump(1, .5, 1000)}, seconds(2000, 5));
    EXPECT_TRUE(composed.values.allFinite());
    EXPECT_LT(composed.values.row(4).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Composition, MotionsGoFromRestToRest) {
    MatrixRows values = bump(0, .5, 0).values;
    for (int i = 0; i < kRows; ++i) {
        values(i, 0) += .1 + .01 * i;
    }
    EXPECT_TRUE(from_rest(values).isApprox(bump(0, .5, 0).values, 1e-12));
    EXPECT_THROW(from_rest(values.topRows(1)), InvalidInput);
}

TEST(Composition, AStillComesStaysAndGoes) {
    const Eigen::Vector2d values(.7, -.2);
    const MatrixRows motion = still_motion(values, 21, 5, 8);
    EXPECT_EQ(motion.row(0).norm(), 0);
    EXPECT_EQ(motion.row(20).norm(), 0);
    for (int i = 5; i <= 12; ++i) {
        EXPECT_TRUE(motion.row(i).isApprox(values.transpose()));
    }
    EXPECT_THROW(still_motion(values, 5, 3, 3), InvalidInput);
}

TEST(Composition, WrongPartsAreRefused) {
    const Eigen::VectorXd times = seconds(1, 5);
    EXPECT_THROW(compose_expressions({}, times), InvalidInput);
    ExpressionPart part = bump(0, .5, 0);
    part.length = 0;
    EXPECT_THROW(compose_expressions({part}, times), InvalidInput);
    part = bump(0, .5, 0);
    part.stds = MatrixRows::Zero(3, 2);
    EXPECT_THROW(compose_expressions({part}, times), InvalidInput);
    part = bump(0, std::nan(""), 0);
    EXPECT_THROW(compose_expressions({part}, times), InvalidInput);
    CompositionOptions options;
    options.fading = -1;
    EXPECT_THROW(compose_expressions({bump(0, .5, 0)}, times, options), InvalidInput);
}

}  // namespace
}  // namespace mimetic
