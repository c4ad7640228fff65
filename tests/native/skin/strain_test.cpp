// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/strain.hpp>

#include "shapes.hpp"

namespace mimetic {
namespace {

Eigen::Matrix3d turn(double angle) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
}

TEST(StrainMeter, StretchAndShearInThePlaneAreTheClosedForm) {
    const Shell shell = make_rectangle(0.1, 0.06, 5, 4);
    Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
    map(0, 0) = 1.2;
    map(0, 1) = 0.3;  // simple shear
    map(1, 1) = 0.9;
    const Points moved =
        (shell.vertices * (turn(2.0) * map).transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
    const Eigen::JacobiSVD<Eigen::Matrix2d> lengths(map.topLeftCorner<2, 2>());
    const Points strain = StrainMeter(shell.vertices, shell.triangles).at_vertices(moved);
    for (Eigen::Index v = 0; v < strain.rows(); ++v) {
        EXPECT_NEAR(strain(v, 0), 1.2 * 0.9 - 1, 1e-12);
        EXPECT_NEAR(strain(v, 1), lengths.singularValues()[0] - 1, 1e-12);
        EXPECT_NEAR(strain(v, 2), lengths.singularValues()[1] - 1, 1e-12);
    }
}

TEST(StrainMeter, TurningAndBendingWithoutStretchStrainNothing) {
    const Shell shell = make_rectangle(0.1, 0.06, 40, 4);
    const StrainMeter meter(shell.vertices, shell.triangles);
    EXPECT_LT(meter.at_vertices(shell.vertices * turn(1.5).transpose()).cwiseAbs().maxCoeff(), 1e-12);
    // Rolled up to a cylinder: chords are shorter than arcs by (step / radius)^2 / 24.
    const double radius = 0.05;
    Points rolled = shell.vertices;
    for (Eigen::Index v = 0; v < rolled.rows(); ++v) {
        const double angle = shell.vertices(v, 0) / radius;
        rolled.row(v) << radius * std::sin(angle), shell.vertices(v, 1), radius * (1 - std::cos(angle));
    }
    const double chord = std::pow(0.1 / 40 / radius, 2) / 24;
    EXPECT_LT(meter.at_vertices(rolled).cwiseAbs().maxCoeff(), 1.01 * chord);
}

TEST(StrainMeter, MeanOverTheSkinIsItsGrowth) {
    const Shell shell = make_rectangle(0.1, 0.06, 6, 5);
    Points moved = shell.vertices;
    moved.col(0) = (moved.col(0).array() * 10).square() * 0.1 + moved.col(0).array();  // uneven
    const Points strain = StrainMeter(shell.vertices, shell.triangles).at_vertices(moved);
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(strain.rows());
    double before = 0;
    double after = 0;
    for (Eigen::Index t = 0; t < shell.triangles.rows(); ++t) {
        const auto area = [&](const Points& points) {
            const Eigen::Vector3d a = points.row(shell.triangles(t, 0));
            const Eigen::Vector3d b = points.row(shell.triangles(t, 1));
            const Eigen::Vector3d c = points.row(shell.triangles(t, 2));
            return (b - a).cross(c - a).norm() / 2;
        };
        before += area(shell.vertices);
        after += area(moved);
        for (const int vertex : shell.triangles.row(t)) {
            weights[vertex] += area(shell.vertices) / 3;
        }
    }
    EXPECT_NEAR(weights.dot(strain.col(0)), after - before, 1e-12);
    EXPECT_GT(after / before, 1.05);
}

TEST(StrainMeter, CollapsedTrianglesAreMinusOne) {
    const Shell shell = make_rectangle(1, 1, 1, 1);
    const Points strain =
        StrainMeter(shell.vertices, shell.triangles).at_vertices(Points::Zero(shell.vertices.rows(), 3));
    EXPECT_TRUE((strain.array() == -1).all());
}

TEST(StrainMeter, NamesWhatIsWrong) {
    Shell shell = make_rectangle(1, 1, 2, 2);
    EXPECT_THROW(StrainMeter(shell.vertices, shell.triangles).at_vertices(Points::Zero(3, 3)), InvalidInput);
    Shell flat = shell;
    flat.vertices.row(4) = (flat.vertices.row(0) + flat.vertices.row(1)) / 2;
    EXPECT_THROW(StrainMeter(flat.vertices, flat.triangles), InvalidInput);
    flat.vertices(4, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(StrainMeter(flat.vertices, flat.triangles), InvalidInput);
    shell.triangles(3, 1) = 9;
    EXPECT_THROW(StrainMeter(shell.vertices, shell.triangles), InvalidInput);
}

}  // namespace
}  // namespace mimetic
