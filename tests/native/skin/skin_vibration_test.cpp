// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <numbers>

#include "shapes.hpp"

namespace mimetic {
namespace {

constexpr double kPi = std::numbers::pi;

/// A rectangle with its edges held: skin, basis and the mass for 2 kg/m^2.
struct HeldPlate {
    HeldPlate(double width, double height, int columns, int rows, const SkinMaterials& materials)
        : shell(make_rectangle(width, height, columns, rows)),
          skin(shell.vertices, shell.triangles, materials,
               make_basis(shell.vertices.rows(), held(width, height))),
          mass(skin_mass(skin, shell.vertices, shell.triangles,
                         Eigen::VectorXd::Constant(shell.vertices.rows(), 2))) {}

    std::vector<bool> held(double width, double height) const {
        std::vector<bool> result(shell.vertices.rows());
        for (int v = 0; v < shell.vertices.rows(); ++v) {
            const Eigen::RowVector3d p = shell.vertices.row(v);
            result[v] = std::min({p.x(), p.y(), width - p.x(), height - p.y()}) < 1e-9;
        }
        return result;
    }

    Shell shell;
    SkinModel skin;
    Eigen::SparseMatrix<double> mass;
};

TEST(SkinMass, OfARigidMotionIsAreaTimesDensity) {
    const Shell shell = make_rectangle(0.3, 0.2, 4, 3);
    const auto count = shell.vertices.rows();
    const SkinModel skin(shell.vertices, shell.triangles, make_materials(count), make_basis(count));
    const Eigen::VectorXd density = Eigen::VectorXd::Constant(count, 2);
    const auto mass = skin_mass(skin, shell.vertices, shell.triangles, density);
    for (int axis = 0; axis < 3; ++axis) {
        Points shift = Points::Zero(count, 3);
        shift.col(axis).setOnes();
        EXPECT_NEAR(flatten(shift).dot(mass * flatten(shift)), 0.3 * 0.2 * 2, 1e-12);
    }
    EXPECT_THROW(skin_mass(skin, shell.vertices, shell.triangles, density.head(3)), InvalidInput);
    EXPECT_THROW(skin_mass(skin, shell.vertices, shell.triangles, -density), InvalidInput);
}

/// Largest relative error of the lowest frequencies of a taut membrane: c / 2 sqrt((m / a)^2 + (n / b)^2).
double drum_error(int columns) {
    SkinMaterials materials = make_materials((columns + 1) * (columns / 2 + 1));
    materials.young.setConstant(1e8);  // so that motion in the plane is far above
    materials.thickness.setConstant(1e-5);
    materials.pre_stress.setConstant(3e6);
    const HeldPlate drum(0.4, 0.2, columns, columns / 2, materials);
    const VibrationModes modes = vibration_modes(drum.skin.stiffness(), drum.mass, 6);
    std::vector<double> exact;
    for (int m = 1; m < 8; ++m) {
        for (int n = 1; n < 8; ++n) {
            exact.push_back(std::sqrt(3e6 * 1e-5 / 2) / 2 * std::hypot(m / 0.4, n / 0.2));
        }
    }
    std::sort(exact.begin(), exact.end());
    double error = 0;
    for (int i = 0; i < 6; ++i) {
        error = std::max(error, std::abs(modes.frequencies[i] / exact[i] - 1));
    }
    return error;
}

TEST(VibrationModes, OfADrumConvergeToTheClosedForm) {
    EXPECT_LT(drum_error(32), 0.02);
    EXPECT_NEAR(std::log2(drum_error(16) / drum_error(32)), 2, 0.3);
}

TEST(VibrationModes, OfASupportedPlateConvergeToTheClosedForm) {
    const auto lowest_error = [](int side) {
        SkinMaterials materials = make_materials((side + 1) * (side + 1));
        materials.young.setConstant(1e9);
        const HeldPlate plate(0.2, 0.2, side, side, materials);
        const double flexural = 1e9 * std::pow(1.5e-3, 3) / 12 / 0.91;
        const double exact = kPi * std::sqrt(flexural / 2) / (0.2 * 0.2);
        return std::abs(vibration_modes(plate.skin.stiffness(), plate.mass, 1).frequencies[0] / exact - 1);
    };
    EXPECT_LT(lowest_error(24), 0.01);
    EXPECT_LT(lowest_error(24), lowest_error(12));
}

TEST(SkinDynamics, SkinLetGoKeepsItsEnergyAndItsPitch) {
    SkinMaterials materials = make_materials(17 * 9);
    materials.pre_stress.setConstant(20e3);
    const HeldPlate plate(0.16, 0.08, 16, 8, materials);
    const VibrationModes modes = vibration_modes(plate.skin.stiffness(), plate.mass, 1);
    DynamicsOptions options;
    options.step = 1 / modes.frequencies[0] / 200;
    SkinDynamics skin(plate.skin.stiffness(), plate.mass, options);
    const Eigen::VectorXd shape = modes.shapes.col(0);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(shape.size());
    skin.start(1e-3 * shape, zero, zero);
    const double before = skin.energy();
    for (int n = 0; n < 200; ++n) {
        skin.advance(zero);
    }
    EXPECT_NEAR(skin.energy(), before, 1e-9 * before);
    EXPECT_LT((skin.state().displacement - 1e-3 * shape).norm(), 1e-3 * 1e-3 * shape.norm());
}

}  // namespace
}  // namespace mimetic
