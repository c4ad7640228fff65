// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/head/mesh_frame.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>
#include <set>

namespace mimetic {
namespace {

constexpr int kMarks = 8;

/// 2000 points in a box of 16 x 20 x 24, of single precision.
Points scattered() {
    Points points(2000, 3);
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const auto n = static_cast<double>(v);
        points.row(v) << 8 * std::sin(1.7 * n), 10 * std::sin(2.9 * n + 1), 12 * std::sin(.7 * n + 2);
    }
    return points.cast<float>().cast<double>();
}

Points rows_of(const Points& points, const std::vector<int>& marks) { return points(marks, Eigen::all); }

TEST(MeshFrame, AnAppliedTransformIsFoundOfAFewVertices) {
    const Points points = scattered();
    const Eigen::Matrix3d applied =
        rotation_from_vector({.4, -1.2, 2}) * Eigen::Vector3d(.01, .01, .02).asDiagonal();
    Points now = (points * applied.transpose()).rowwise() + Eigen::RowVector3d(.3, -.2, 1.5);
    now = now.cast<float>().cast<double>().eval();
    const std::vector<int> marks = marks_of(points, kMarks);
    const Eigen::Matrix4d found = now_from_noted(rows_of(points, marks), rows_of(now, marks));
    const Points there = (points * found.topLeftCorner<3, 3>().transpose()).rowwise() +
                         found.topRightCorner<3, 1>().transpose();
    EXPECT_LT((there - now).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(MeshFrame, WhatIsNoTransformOfTheWholeChangesNothing) {
    const Points points = scattered();
    const std::vector<int> marks = marks_of(points, kMarks);
    const auto expect_still = [&](const Points& before, const Points& now) {
        EXPECT_EQ(now_from_noted(rows_of(before, marks), rows_of(now, marks)), Eigen::Matrix4d::Identity());
    };
    expect_still(points, points);
    Points dragged = points;
    dragged(marks[3], 1) += .05;
    expect_still(points, dragged);
    Points bent = points;
    bent.col(2) += .01 * points.col(0).cwiseAbs2();
    expect_still(points, bent);
    Points flat = points;
    flat.col(2).setZero();
    expect_still(flat, 2 * points);
    expect_still(flat, 2 * flat);
    Points squashed = points;
    squashed.col(1).setZero();
    expect_still(points, squashed);
}

TEST(MeshFrame, AMeshOfFewVerticesHasMarks) {
    const std::vector<int> marks = marks_of(Points::Identity(3, 3), kMarks);
    EXPECT_EQ(marks.size(), kMarks);
    EXPECT_EQ(std::set<int>(marks.begin(), marks.end()), (std::set<int>{0, 1, 2}));
    EXPECT_THROW(marks_of(Points(0, 3), kMarks), InvalidInput);
}

}  // namespace
}  // namespace mimetic
