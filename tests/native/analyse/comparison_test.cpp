// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/analyse/action_units.hpp>
#include <mimetic/analyse/comparison.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

Points cube() {
    Points corners(9, 3);
    corners << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, .4, .5, .3;
    return corners;
}

TEST(PointWarp, KeepsAffineMapsAndMeetsItsPoints) {
    Eigen::Matrix3d turn;
    turn << 1.2, .1, 0, -.2, .9, .3, 0, .1, 1.1;
    Points to = cube() * turn;
    to.rowwise() += Eigen::RowVector3d(1, 2, 3);
    Points elsewhere(1, 3);
    elsewhere << 2, -1, .5;
    const Points expected = (elsewhere * turn).rowwise() + Eigen::RowVector3d(1, 2, 3);
    EXPECT_TRUE(PointWarp(cube(), to)(elsewhere).isApprox(expected, 1e-9));
    to(3, 1) += .2;
    EXPECT_TRUE(PointWarp(cube(), to)(cube()).isApprox(to, 1e-9));
    EXPECT_THROW(PointWarp(cube().topRows(4), to.topRows(4)), InvalidInput);
    Points flat = cube();
    flat.col(2).setZero();
    EXPECT_THROW(PointWarp(flat, to), InvalidInput);
}

TEST(ActionUnits, SkinMovesWithItsPointAndNotBeyondTheRadius) {
    Points vertices(4, 3), places(2, 3), moved(2, 3);
    vertices << 0, 0, 0, .01, 0, 0, .03, 0, 0, 0, 0, 0;
    places << 0, 0, 0, 0, 0, 0;
    moved << 0, .01, 0, 0, .01, 0;
    const Points field = displacement_about(vertices, {true, true, true, false}, places, moved, .02);
    EXPECT_NEAR(field(0, 1), .01, 1e-12);  // two points at one place are not twice the motion
    EXPECT_NEAR(field(1, 1), .005, 1e-12);
    EXPECT_TRUE(field.bottomRows(2).isZero());
    const Eigen::VectorXd near = nearness_to(vertices, {true, true, true, false}, places, .02);
    EXPECT_TRUE(near.isApprox(Eigen::Vector4d(1, .5, 0, 0)));
    EXPECT_THROW(nearness_to(vertices, {true}, places, .02), InvalidInput);
}

TEST(Comparison, AUnitExplainsItselfAndHasNoEnergyOutside) {
    Points unit = Points::Zero(4, 3), seen, vertices = Points::Zero(4, 3);
    vertices.col(1) << 0, .01, .024, .05;
    unit.row(0) << 0, .01, 0;
    unit.row(1) << 0, .005, 0;
    const Eigen::Vector4d areas(1, 1, 1, 0), stds(.001, .001, .004, 0), reach(1, .5, 0, 0);
    seen = .6 * unit;
    const SpatialComparison same = compare_displacements(vertices, seen, unit, areas, stds, reach);
    EXPECT_NEAR(same.intensity, .6, 1e-12);
    EXPECT_NEAR(same.inside_explained, 1, 1e-12);
    EXPECT_EQ(same.outside_share, 0);
    seen.row(2) << .006, 0, 0;
    seen.row(3) << 9, 9, 9;  // no area: not of the face
    SpatialComparison more = compare_displacements(vertices, seen, unit, areas, stds, reach);
    EXPECT_NEAR(more.outside_share, 36. / (36 + 36 + 9), 1e-12);
    EXPECT_EQ(more.outside_significant_share, 0);  // within two standard deviations
    EXPECT_EQ(more.outside_far_share, 0);          // 14 mm from the region's nearest vertex
    vertices(2, 1) = .026;
    more = compare_displacements(vertices, seen, unit, areas, stds, reach);
    EXPECT_EQ(more.outside_far_share, more.outside_share);
    EXPECT_TRUE(
        std::isnan(compare_displacements(vertices, 0 * seen, unit, areas, stds, reach).outside_share));
}

TEST(Comparison, EvenMotionOfUnevenAreasHasNoGini) {
    const Points unit = Points::Zero(4, 3), vertices = Points::Zero(4, 3);
    Points seen = Points::Zero(4, 3);
    seen.col(1).setConstant(.005);
    const Eigen::Vector4d areas(1, .1, 4, 0), stds = Eigen::Vector4d::Zero(), reach(1, 1, 0, 0);
    EXPECT_NEAR(compare_displacements(vertices, seen, unit, areas, stds, reach).gini, 0, 1e-12);
    seen.topRows(2).setZero();  // all in four parts of 5.1
    EXPECT_NEAR(compare_displacements(vertices, seen, unit, areas, stds, reach).gini, 1.1 / 5.1, 1e-12);
    EXPECT_TRUE(std::isnan(compare_displacements(vertices, unit, unit, areas, stds, reach).gini));
}

TEST(Comparison, TheBestRampBeginsAndEndsBetweenRows) {
    Eigen::VectorXd course(60);
    for (int i = 0; i < 60; ++i) {
        course[i] = .9 * std::min(std::clamp((i - 8.4) / 6.9, 0., 1.), std::clamp((45.6 - i) / 9.3, 0., 1.));
    }
    Eigen::RowVectorXd pattern(3);
    pattern << .01, 0, 0;
    const TemporalComparison found = compare_courses(course * pattern, Eigen::VectorXd::Ones(1), 9, 16);
    EXPECT_GT(found.ramp_whole_explained, .99999);
    EXPECT_TRUE(found.ramp.isApprox(found.course, .005));
}

TEST(Comparison, OnePatternByAStraightRampIsTold) {
    Eigen::VectorXd course(20), curved(20);
    for (int i = 0; i < 20; ++i) {
        course[i] = i < 4 ? 0 : i < 12 ? (i - 4) / 8. : 1;
        curved[i] = i < 4 ? 0 : i < 12 ? std::pow((i - 4) / 8., 3) : 1;
    }
    Eigen::RowVectorXd pattern(6);
    pattern << .01, 0, 0, 0, .004, 0;
    const Eigen::Vector2d areas(1, 2);
    const TemporalComparison straight = compare_courses(course * pattern, areas, 4, 12);
    EXPECT_NEAR(straight.rank_one_share, 1, 1e-12);
    EXPECT_NEAR(straight.ramp_explained, 1, 1e-9);
    EXPECT_GT(straight.ramp_whole_explained, .999);
    MatrixRows two = curved * pattern;
    two.col(1) = .01 * course;
    const TemporalComparison bent = compare_courses(two, areas, 4, 12);
    EXPECT_LT(bent.rank_one_share, .999);
    EXPECT_LT(bent.ramp_explained, .95);
    EXPECT_THROW(compare_courses(two, areas, 12, 12), InvalidInput);
}

TEST(Comparison, DeviationsAddInSquaresAndFacesAwayAreNotSeen) {
    MatrixRows modes(2, 3);
    modes << .003, 0, 0, 0, .004, 0;
    EXPECT_NEAR(displacement_std(modes, Eigen::Vector2d(1, 1))[0], .005, 1e-12);
    Points square(4, 3);
    square << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    Quads faces(2, 4);
    faces << 0, 1, 2, 3, 3, 2, 1, 0;
    EXPECT_EQ(faces_in_view(square, faces).faces, std::vector<int>({0}));
    EXPECT_NEAR(skin_areas(square, faces.topRows(1), {true, true, true, true}).sum(), 1, 1e-12);
}

}  // namespace
}  // namespace mimetic
