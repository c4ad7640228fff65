// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr int kSide = 40;  // quads
constexpr double kStep = 0.002;

/// A square of skin in the plane z = 0, its middle at the origin, bulging by `rise` towards its middle.
Points make_vertices(double rise = 0) {
    Points vertices((kSide + 1) * (kSide + 1), 3);
    for (int i = 0; i < vertices.rows(); ++i) {
        const double x = kStep * (i % (kSide + 1) - kSide / 2);
        const double y = kStep * (i / (kSide + 1) - kSide / 2);
        vertices.row(i) << x, y, rise * (1 - (x * x + y * y) / 0.0032);
    }
    return vertices;
}

Triangles make_triangles() {
    Triangles triangles(2 * kSide * kSide, 3);
    for (int f = 0; f < kSide * kSide; ++f) {
        const int a = f / kSide * (kSide + 1) + f % kSide;
        const int b = a + 1;
        const int c = b + kSide + 1;
        triangles.row(2 * f) << a, b, c;
        triangles.row(2 * f + 1) << a, c, c - 1;
    }
    return triangles;
}

MuscleSurface make_surface(double rise = 0) {
    return {make_vertices(rise), make_triangles(), std::vector<bool>(2 * kSide * kSide, true)};
}

Muscle make_linear() {
    Muscle muscle;
    muscle.insertion = Points::Zero(1, 3);
    muscle.origin << 0.03, 0.02, -0.01;
    return muscle;
}

TEST(MuscleSurface, DistancesFollowAPlaneWithinFivePercentOnAverage) {
    const Points vertices = make_vertices();
    const Eigen::VectorXd distance = make_surface().distances(Points::Zero(1, 3), 1);
    const Eigen::VectorXd straight = vertices.rowwise().norm();
    double excess = 0;
    for (int v = 0; v < vertices.rows(); ++v) {
        EXPECT_GE(distance[v], straight[v] - 1e-12);
        EXPECT_LE(distance[v], 1.09 * straight[v] + 1e-12);
        excess += straight[v] > 0 ? distance[v] / straight[v] - 1 : 0;
    }
    EXPECT_LT(excess / static_cast<double>(vertices.rows()), 0.06);
}

TEST(MuscleSurface, DistancesGoRoundASlit) {
    const Points vertices = make_vertices();
    const Triangles triangles = make_triangles();
    std::vector<bool> carries(triangles.rows());
    for (int f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3d middle = (vertices.row(triangles(f, 0)) + vertices.row(triangles(f, 2))) / 2;
        carries[f] = std::abs(middle.y() - 0.001) > 0.0015 || std::abs(middle.x()) > 0.02;
    }
    const MuscleSurface surface(vertices, triangles, carries);
    Points source(1, 3);
    source << 0, 0.006, 0;
    const Eigen::VectorXd distance = surface.distances(source, 1);
    const int opposite = (kSide / 2 - 2) * (kSide + 1) + kSide / 2;  // (0, -0.004)
    EXPECT_GT(distance[opposite], 0.038);
    EXPECT_TRUE(std::isinf(surface.distances(source, 0.02)[opposite]));
}

TEST(MuscleSurface, LinearMusclePullsWithOneNewtonAlongTheSkin) {
    const Points forces = make_surface().forces(make_linear());
    const Eigen::RowVector3d total = forces.colwise().sum();
    const Eigen::RowVector3d fibre = Eigen::RowVector3d(0.03, 0.02, -0.01).normalized();
    EXPECT_NEAR(total.x(), fibre.x(), 1e-9);
    EXPECT_NEAR(total.y(), fibre.y(), 1e-9);
    EXPECT_NEAR(total.z(), 0.1 * fibre.z(), 1e-9);  // the share across the skin
    const int middle = kSide / 2 * (kSide + 1) + kSide / 2;
    EXPECT_NEAR(forces.row(middle + 3).norm() / forces.row(middle).norm(), std::exp(-0.5),
                1e-6);  // one s.d. aside
}

TEST(MuscleSurface, SheetPullsEvenlyAlongItsEdge) {
    Muscle sheet = make_linear();
    sheet.type = MuscleType::sheet;
    sheet.insertion.resize(2, 3);
    sheet.insertion << -0.01, 0, 0, 0.01, 0, 0;
    sheet.origin << 0, 0.03, 0;
    const Points forces = make_surface().forces(sheet);
    EXPECT_NEAR(forces.col(1).sum(), 1, 1e-9);
    const int middle = kSide / 2 * (kSide + 1) + kSide / 2;
    for (int column = -5; column <= 5; ++column) {
        EXPECT_NEAR(forces(middle + column, 1), forces(middle, 1), 0.02 * forces(middle, 1));
    }
}

TEST(MuscleSurface, SphincterIsInBalanceAndClosesTheRing) {
    Muscle ring;
    ring.type = MuscleType::sphincter;
    ring.insertion.resize(2, 3);
    ring.insertion << 0.015, 0, 0.004, -0.015, 0, 0.004;
    ring.width = 0.006;
    ring.swelling = 0.3;
    const Points vertices = make_vertices(0.01);
    const MuscleSurface surface = make_surface(0.01);
    const Points forces = surface.forces(ring);
    Eigen::RowVector3d moment = Eigen::RowVector3d::Zero();
    for (int v = 0; v < vertices.rows(); ++v) {
        moment += vertices.row(v).cross(forces.row(v));
    }
    EXPECT_LT(forces.colwise().sum().norm(), 1e-9 * forces.norm());
    EXPECT_LT(moment.norm(), 1e-9 * forces.norm());
    double inwards = 0;  // work of the forces if the ring shrinks
    for (int v = 0; v < vertices.rows(); ++v) {
        inwards -= forces.row(v).dot(vertices.row(v));
    }
    EXPECT_GT(inwards, 0);
    ring.protrusion = 1;
    EXPECT_GT(surface.forces(ring).col(2).sum(), 0);
}

TEST(MuscleSurface, RejectsWhatCannotPull) {
    const MuscleSurface surface = make_surface();
    Muscle muscle = make_linear();
    muscle.width = 0;
    EXPECT_THROW(surface.forces(muscle), InvalidInput);
    muscle = make_linear();
    muscle.origin.setZero();
    EXPECT_THROW(surface.forces(muscle), InvalidInput);
    muscle = make_linear();
    muscle.insertion(0, 1) = NAN;
    EXPECT_THROW(surface.forces(muscle), InvalidInput);
    muscle = make_linear();
    muscle.type = MuscleType::sphincter;
    EXPECT_THROW(surface.forces(muscle), InvalidInput);
    EXPECT_THROW(MuscleSurface(make_vertices(), make_triangles(), std::vector<bool>(2 * kSide * kSide)),
                 InvalidInput);
    EXPECT_THROW(MuscleSurface(make_vertices(), make_triangles(), {true}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
