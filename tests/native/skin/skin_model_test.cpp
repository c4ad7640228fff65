// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <mimetic/shared/error.hpp>

#include "shapes.hpp"

namespace mimetic {
namespace {

TEST(SkinModel, PassesThePatchTest) {
    Shell patch = make_rectangle(0.04, 0.03, 4, 4);
    for (int v = 0; v < patch.vertices.rows(); ++v) {  // irregular inside
        const bool inside = v % 5 != 0 && v % 5 != 4 && v >= 5 && v < 20;
        patch.vertices(v, 0) += inside ? 0.003 * std::sin(7.0 * v) : 0;
        patch.vertices(v, 1) += inside ? 0.002 * std::cos(5.0 * v) : 0;
    }
    const SkinModel skin(patch.vertices, patch.triangles, make_materials(25), make_basis(25));
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient.topLeftCorner<2, 2>() << 2e-3, 1e-3, -3e-4, -1e-3;
    const Points u = patch.vertices * gradient.transpose();
    const Eigen::VectorXd force = skin.stiffness() * flatten(u);
    for (int v = 0; v < 25; ++v) {
        if (v % 5 != 0 && v % 5 != 4 && v >= 5 && v < 20) {
            EXPECT_LT(force.segment<3>(3 * v).norm(), 1e-12 * force.norm() + 1e-16) << "vertex " << v;
        }
    }
    // Energy of plane stress at this strain: E t A / (2 (1 - nu^2)) (exx^2 + eyy^2 + 2 nu exx eyy + (1 - nu)
    // gxy^2 / 2)
    const double strain = 4e-6 + 1e-6 + 2 * 0.3 * 2e-3 * -1e-3 + 0.35 * 0.49e-6;
    const double energy = 40e3 * 1.5e-3 * 0.04 * 0.03 / 2 / 0.91 * strain;
    EXPECT_NEAR(flatten(u).dot(force) / 2, energy, 1e-9 * energy);
}

TEST(SkinModel, OnlyRigidMotionIsFreeBeforeItIsAttached) {
    const Shell pebble = make_pebble(1);
    const auto count = pebble.vertices.rows();
    const SkinModel skin(pebble.vertices, pebble.triangles, make_materials(count), make_basis(count));
    const Eigen::MatrixXd stiffness = skin.stiffness();
    EXPECT_LT((stiffness - stiffness.transpose()).norm(), 1e-12 * stiffness.norm());
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
    const double largest = values[values.size() - 1];
    for (int i = 0; i < 6; ++i) {
        EXPECT_LT(std::abs(values[i]), 1e-12 * largest) << "mode " << i;
    }
    EXPECT_GT(values[6], 1e-8 * largest);
    for (int axis = 0; axis < 3; ++axis) {
        Points turn(count, 3);
        for (int v = 0; v < count; ++v) {
            turn.row(v) = Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(pebble.vertices.row(v)));
        }
        EXPECT_LT((stiffness * flatten(turn)).norm(), 1e-12 * largest * turn.norm());
    }
}

TEST(SkinModel, PullOnTheEdgeDecaysAsOnAWinklerFoundation) {
    constexpr double kDecay = 0.02;
    constexpr int kColumns = 32;  // 4 elements a decay length, 8 lengths
    const Shell strip = make_rectangle(8 * kDecay, 0.01, kColumns, 2);
    const auto count = strip.vertices.rows();
    SkinMaterials materials = make_materials(count);
    materials.poisson.setZero();
    materials.tangential.setConstant(40e3 * 1.5e-3 / (kDecay * kDecay));
    materials.normal.setConstant(1e6);
    const SkinModel skin(strip.vertices, strip.triangles, materials, make_basis(count));
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3 * count, 1);
    for (int row = 0; row < 3; ++row) {
        force(3 * row * (kColumns + 1)) = row == 1 ? 0.5 : 0.25;
    }
    const Eigen::MatrixXd u = skin.solve(force);
    const int middle = kColumns + 1;
    for (int column = 0; column <= 8; ++column) {
        const double expected = std::exp(-0.25 * column);
        EXPECT_NEAR(u(3 * (middle + column), 0) / u(3 * middle, 0), expected, 0.02 * expected)
            << "column " << column;
    }
}

/// Deflection of the middle of a simply supported square plate under even load, over q L^4 / D.
double plate_deflection(int side) {
    const Shell plate = make_rectangle(1, 1, side, side);
    const auto count = plate.vertices.rows();
    SkinMaterials materials = make_materials(count);
    materials.young.setConstant(1e6);
    materials.thickness.setConstant(0.01);
    std::vector<bool> held(count);
    for (int v = 0; v < count; ++v) {
        const Eigen::RowVector3d p = plate.vertices.row(v);
        held[v] = std::min({p.x(), p.y(), 1 - p.x(), 1 - p.y()}) < 1e-9;
    }
    const SkinModel skin(plate.vertices, plate.triangles, materials, make_basis(count, held));
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3 * count, 1);
    for (int v = 0; v < count; ++v) {
        force(3 * v + 2) = 1.0 / (side * side);
    }
    const Eigen::MatrixXd u = skin.solve(force);
    const int middle = (side / 2 - 1) * (side - 1) + side / 2 - 1;  // among the vertices inside
    return u(3 * middle + 2, 0) * (1e6 * 1e-6 / 12 / 0.91);
}

TEST(SkinModel, BendsAsTheThinPlateOfTimoshenko) {
    const double exact = 0.004062;
    const double coarse = std::abs(plate_deflection(16) - exact);
    const double fine = std::abs(plate_deflection(32) - exact);
    EXPECT_LT(fine, 0.01 * exact);
    EXPECT_LT(fine, coarse);
}

TEST(SkinModel, WorkOfTheLoadIsTwiceTheEnergy) {
    const Shell pebble = make_pebble(2);
    const auto count = pebble.vertices.rows();
    SkinMaterials materials = make_materials(count);
    materials.pre_stress.setConstant(20e3);
    materials.tangential.setConstant(1e5);
    materials.normal.setConstant(1e6);
    const SkinModel skin(pebble.vertices, pebble.triangles, materials, make_basis(count));
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3 * count, 2);
    force(7, 0) = 1;
    force.col(1).setLinSpaced(-1, 1);
    const Eigen::MatrixXd u = skin.solve(force);
    for (int k = 0; k < 2; ++k) {
        const double work = u.col(k).dot(force.col(k));
        EXPECT_NEAR(u.col(k).dot(skin.stiffness() * u.col(k)), work, 1e-9 * work);
        EXPECT_GT(work, 0);
    }
}

TEST(SkinModel, BoneThatMovesAsOneTakesTheSkinAlong) {
    const Shell plate = make_rectangle(0.1, 0.1, 8, 8);
    const auto count = plate.vertices.rows();
    SkinMaterials materials = make_materials(count);
    materials.tangential.setConstant(1e5);
    materials.normal.setConstant(1e6);
    const SkinModel skin(plate.vertices, plate.triangles, materials, make_basis(count));
    const Points shift = Eigen::RowVector3d(1e-3, 2e-3, -3e-3).replicate(count, 1);
    const Eigen::MatrixXd u = skin.solve(flatten(skin.foundation_forces(shift)));
    EXPECT_LT((u - flatten(shift)).norm(), 1e-9 * flatten(shift).norm());
}

TEST(SkinModel, FewerUnknownsNeverGiveMoreWay) {
    // Galerkin: the response within a subspace stores at most the energy of the full response.
    Points corners(9, 3);
    Quads quads(4, 4);
    for (int i = 0; i < 9; ++i) {
        corners.row(i) << 0.02 * (i % 3), 0.02 * (i / 3), 0.003 * (i == 4);
    }
    quads << 0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7;
    const SubdividedMesh mesh(quads, 9, 2);
    Triangles triangles(2 * mesh.faces().rows(), 3);
    for (int f = 0; f < mesh.faces().rows(); ++f) {
        const Eigen::RowVector4i q = mesh.faces().row(f);
        triangles.middleRows<2>(2 * f) << q[0], q[1], q[2], q[0], q[2], q[3];
    }
    const Points vertices = mesh.positions(corners);
    SkinMaterials materials = make_materials(vertices.rows());
    materials.tangential.setConstant(1e5);
    materials.normal.setConstant(1e6);
    const SkinModel full(vertices, triangles, materials, make_basis(vertices.rows()));
    const SkinModel reduced(vertices, triangles, materials, mesh.stencils());
    EXPECT_EQ(reduced.num_unknowns(), 9);
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3 * vertices.rows(), 1);
    force(3 * 4) = 1;
    const Eigen::MatrixXd c = reduced.solve(force);
    const Points control = Eigen::Map<const Points>(c.data(), 9, 3);
    const double reduced_work = flatten(mesh.stencils() * control).dot(force.col(0));
    const double full_work = full.solve(force).col(0).dot(force.col(0));
    EXPECT_GT(reduced_work, 0);
    EXPECT_LT(reduced_work, full_work);
}

}  // namespace
}  // namespace mimetic
