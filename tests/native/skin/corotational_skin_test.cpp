// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/corotational_skin.hpp>
#include <random>

#include "../../../native/src/skin/corotational_element.hpp"
#include "shapes.hpp"

namespace mimetic {
namespace {

Eigen::VectorXd noise(Eigen::Index size, double amplitude) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, amplitude);
    return Eigen::VectorXd::NullaryExpr(size, [&](Eigen::Index) { return normal(random); });
}

/// A curved, closed skin; attached and pre-stressed or free.
struct Pebble {
    explicit Pebble(bool attached)
        : shell(make_pebble(2)),
          materials(make_materials(shell.vertices.rows())),
          skin(shell.vertices, shell.triangles, (attach(attached), materials),
               make_basis(shell.vertices.rows())) {}

    void attach(bool attached) {
        if (attached) {
            materials.tangential.setConstant(1e5);
            materials.normal.setConstant(1e6);
            materials.pre_stress.setConstant(20e3);
        }
    }

    Shell shell;
    SkinMaterials materials;
    CorotationalSkin skin;
};

TEST(CorotationalSkin, RigidMotionMeetsNoForce) {
    const Pebble pebble(false);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).matrix();
    Points moved = pebble.shell.vertices * turn.transpose();
    moved.rowwise() += Eigen::RowVector3d(0.1, 0.2, -0.3);
    const Eigen::VectorXd u = flatten(moved - pebble.shell.vertices);
    // Against the force of the linear skin for the same motion
    const double linear = (pebble.skin.linear().stiffness() * u).norm();
    EXPECT_LT(pebble.skin.gradient(u).norm(), 1e-10 * linear);
    EXPECT_LT(pebble.skin.energy(u), 1e-12 * u.dot(pebble.skin.linear().stiffness() * u));
}

TEST(CorotationalSkin, HasTheLinearStiffnessAtRest) {
    const Pebble pebble(true);
    const Eigen::VectorXd direction = noise(3 * pebble.shell.vertices.rows(), 1);
    const double step = 1e-9;
    const Eigen::VectorXd slope =
        (pebble.skin.gradient(step * direction) - pebble.skin.gradient(-step * direction)) / (2 * step);
    const Eigen::VectorXd expected = pebble.skin.linear().stiffness() * direction;
    EXPECT_LT((slope - expected).norm(), 1e-6 * expected.norm());
}

/// Compares the gradient with differences of the energy about `u`.
void expect_slope(const Pebble& pebble, const Eigen::VectorXd& u) {
    const Eigen::VectorXd gradient = pebble.skin.gradient(u);
    for (int trial = 0; trial < 5; ++trial) {
        Eigen::VectorXd direction = Eigen::VectorXd::Zero(u.size());
        direction.segment<9>(40 * trial) = noise(9, 1).cwiseProduct(Eigen::VectorXd::LinSpaced(9, 1, trial));
        const double step = 1e-7;
        const double slope =
            (pebble.skin.energy(u + step * direction) - pebble.skin.energy(u - step * direction)) /
            (2 * step);
        EXPECT_NEAR(slope, gradient.dot(direction), 1e-6 * gradient.norm() * direction.norm());
    }
}

TEST(CorotationalSkin, GradientIsTheSlopeOfTheEnergyWhereItIsTurnedAndWrinkled) {
    const Pebble pebble(true);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY()).matrix();
    const Points turned = pebble.shell.vertices * turn.transpose();
    expect_slope(pebble,
                 flatten(turned - pebble.shell.vertices) + noise(3 * pebble.shell.vertices.rows(), 5e-4));
}

TEST(CorotationalSkin, GradientIsTheSlopeOfTheEnergyWhereItIsNearlyCrushed) {
    const Pebble pebble(true);
    const auto size = 3 * pebble.shell.vertices.rows();
    const Points shrunk = pebble.shell.vertices * Eigen::Vector3d(0.3, 0.5, 0.8).asDiagonal();
    expect_slope(pebble, flatten(shrunk - pebble.shell.vertices) + noise(size, 1e-4));
}

TEST(CorotationalSkin, StressGrowsWithoutBoundAsAFibreIsCrushed) {
    const auto stress_at = [](double length) {
        const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.4).toRotationMatrix();
        const Eigen::Matrix2d stretch = turn * Eigen::Vector2d(length, 1).asDiagonal() * turn.transpose();
        return Eigen::Matrix2d(turn.transpose() * MembraneState(stretch, 1, 0).stress * turn);
    };
    EXPECT_NEAR(stress_at(0.7)(0, 0), -0.3, 1e-12);  // linear
    EXPECT_LT(stress_at(0.1)(0, 0), -5);
    EXPECT_LT(stress_at(0.01)(0, 0), -30);
    EXPECT_NEAR(stress_at(0.1)(1, 1), 0, 1e-12);
    EXPECT_NEAR(stress_at(0.6 - 1e-6)(0, 0), stress_at(0.6)(0, 0), 2e-6);  // without a jump
}

TEST(CorotationalSkin, SmallLoadsGiveTheLinearAnswer) {
    const Pebble pebble(true);
    const auto size = 3 * pebble.shell.vertices.rows();
    const Eigen::VectorXd force = noise(size, 1e-7);
    const CorotationalSolution solution = pebble.skin.solve(force);
    const Eigen::VectorXd linear = pebble.skin.linear().solve(force);
    EXPECT_TRUE(solution.converged);
    EXPECT_LT((solution.unknowns - linear).norm(), 1e-4 * linear.norm());
}

TEST(CorotationalSkin, BalancesLargeLoads) {
    const Pebble pebble(true);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * pebble.shell.vertices.rows());
    for (int v = 0; v < pebble.shell.vertices.rows(); ++v) {  // twisted about z
        force.segment<3>(3 * v) << -pebble.shell.vertices(v, 1), pebble.shell.vertices(v, 0), 0;
    }
    force *= 8;
    const CorotationalSolution solution = pebble.skin.solve(force);
    EXPECT_TRUE(solution.converged) << solution.residual;
    EXPECT_LT((pebble.skin.gradient(solution.unknowns) - force).norm(), 1e-4 * force.norm() * 1.01);
    const Eigen::VectorXd linear = pebble.skin.linear().solve(force);
    EXPECT_GT((solution.unknowns - linear).norm(), 0.01 * linear.norm());
}

}  // namespace
}  // namespace mimetic
