// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/locate/joined_eye.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mimetic::locate {
namespace {

constexpr int kMargin = RegressedEye::kMargin;
constexpr double kSide = 50;  // pixels
constexpr double kSure = .003, kLost = .3;

/// An eye as wide as .4 whose lids are `open` apart in the middle.
EyePoints eye_of(double open) {
    EyePoints eye{Points2::Constant(EyePoints::kContour, 2, .5), Points2::Constant(EyePoints::kIris, 2, .5)};
    for (int i = 0; i < kMargin; ++i) {
        const double x = .3 + .4 * i / (kMargin - 1), half = .5 * open * std::sin(M_PI * (x - .3) / .4);
        eye.contour.row(LidMargins::kUpper[i]) << x, .5 - half;
        eye.contour.row(LidMargins::kLower[i]) << x, .5 + half;
    }
    return eye;
}

RegressedPoints regressed_of(double open, double spread) {
    const EyePoints eye = eye_of(open);
    RegressedPoints seen{Points2(RegressedEye::kPoints, 2),
                         Eigen::VectorXd::Constant(RegressedEye::kGroups, spread)};
    for (int i = 0; i < kMargin; ++i) {
        seen.shares.row(i) = eye.contour.row(LidMargins::kUpper[i]);
        seen.shares.row(kMargin + i) = eye.contour.row(LidMargins::kLower[i]);
    }
    seen.shares.bottomRows(EyePoints::kIris) = eye.iris;
    return seen;
}

double opening_of(const EyePoints& eye) {
    return eye.contour(LidMargins::kLower[4], 1) - eye.contour(LidMargins::kUpper[4], 1);
}

TEST(JoinedEye, WhatBothSeeAlikeStays) {
    const EyePoints eye = eye_of(.15), joined = joined_eye(eye, regressed_of(.15, kSure), kSide);
    EXPECT_LT((joined.contour - eye.contour).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((joined.iris - eye.iris).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(JoinedEye, LidsLieBetweenBothByTheirErrors) {
    const EyePoints eye = eye_of(.2);
    const double sure = opening_of(joined_eye(eye, regressed_of(.1, kSure), kSide));
    EXPECT_GT(sure, .12);
    EXPECT_LT(sure, .18);
    const double lost = opening_of(joined_eye(eye, regressed_of(.1, kLost), kSide));
    EXPECT_GT(lost, .1999);
}

TEST(JoinedEye, CornersAndIrisStayTheNetworks) {
    RegressedPoints aside = regressed_of(.1, kSure);
    aside.shares.col(0).array() += .02;
    const EyePoints eye = eye_of(.2), joined = joined_eye(eye, aside, kSide);
    EXPECT_EQ(joined.contour.row(LidMargins::kUpper.front()), eye.contour.row(LidMargins::kUpper.front()));
    EXPECT_EQ(joined.contour.row(LidMargins::kLower.back()), eye.contour.row(LidMargins::kLower.back()));
    EXPECT_EQ(joined.iris, eye.iris);
}

TEST(JoinedEye, MarginsAreComparedAsFarAlong) {
    RegressedPoints uneven =
        regressed_of(.2, kSure);  // the same margins, stations nearer to the outer corner
    const EyePoints eye = eye_of(.2);
    for (int i = 0; i < kMargin; ++i) {
        const double x = .3 + .4 * std::pow(i / (kMargin - 1.), 1.4);
        const double half = .1 * std::sin(M_PI * (x - .3) / .4);
        uneven.shares.row(i) << x, .5 - half;
        uneven.shares.row(kMargin + i) << x, .5 + half;
    }
    EXPECT_LT((joined_eye(eye, uneven, kSide).contour - eye.contour).cwiseAbs().maxCoeff(), .004);
}

TEST(JoinedEye, AnEyeSeenInOnePointStaysFinite) {
    const EyePoints nowhere{Points2::Constant(EyePoints::kContour, 2, .5),
                            Points2::Constant(EyePoints::kIris, 2, .5)};
    EXPECT_TRUE(joined_eye(nowhere, regressed_of(.1, kSure), kSide).contour.allFinite());
}

}  // namespace
}  // namespace mimetic::locate
