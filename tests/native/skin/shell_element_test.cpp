// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/skin/shell_element.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <mimetic/shared/error.hpp>

#include "shapes.hpp"

namespace mimetic {
namespace {

using Vector18 = Eigen::Matrix<double, 18, 1>;

class ShellElement : public testing::Test {
protected:
    ShellElement() {
        corners << 0.011, 0.002, -0.004, 0.019, 0.005, 0.003, 0.008, 0.013, 0.001;
        triangle = make_skin_triangle(corners, {0, 1, 2});
    }

    Points corners{3, 3};
    SkinTriangle triangle;
    ShellMaterial material{1e6, 0.3, 1e-3, 1000};
};

TEST_F(ShellElement, PlateGivesTheCurvatureOfAQuadraticEverywhere) {
    const Eigen::Matrix<double, 2, 3> p = triangle.axes * triangle.corners;
    Eigen::Matrix<double, 9, 1> u;  // w = 3 x^2 / 2 + 5 y^2 / 2 + 7 x y
    for (int k = 0; k < 3; ++k) {
        const double x = p(0, k);
        const double y = p(1, k);
        u.segment<3>(3 * k) << 1.5 * x * x + 2.5 * y * y + 7 * x * y, 5 * y + 7 * x, -(3 * x + 7 * y);
    }
    for (const auto& [xi, eta] : {std::pair(0.5, 0.0), std::pair(0.2, 0.3), std::pair(0.0, 1.0)}) {
        const Eigen::Vector3d curvature = plate_curvature(triangle, xi, eta) * u;
        EXPECT_LT((curvature + Eigen::Vector3d(3, 5, 14)).norm(), 1e-11);
    }
}

TEST_F(ShellElement, PlateStoresTheEnergyOfUniformBending) {
    const Eigen::Matrix<double, 2, 3> p = triangle.axes * triangle.corners;
    Eigen::Matrix<double, 9, 1> u;
    for (int k = 0; k < 3; ++k) {  // w = x^2 / 2
        u.segment<3>(3 * k) << p(0, k) * p(0, k) / 2, 0, -p(0, k);
    }
    const double plate = 1e6 * 1e-9 / 12 / (1 - 0.09);
    const double energy = u.dot(plate_stiffness(triangle, material) * u) / 2;
    EXPECT_NEAR(energy, plate * triangle.area / 2, 1e-10 * energy);
}

TEST_F(ShellElement, OnlyRigidMotionIsFree) {
    const Matrix18 stiffness = shell_stiffness(triangle, material);
    EXPECT_LT((stiffness - stiffness.transpose()).norm(), 1e-14 * stiffness.norm());
    const Vector18 values = Eigen::SelfAdjointEigenSolver<Matrix18>(stiffness).eigenvalues();
    EXPECT_GT(values[0], -1e-14 * values[17]);
    // Three shifts, three turns, and the common turn about the normal, which a flat triangle does not feel.
    EXPECT_EQ((values.array() < 1e-13 * values[17]).count(), 7);
    const Eigen::Vector3d turn(0.3, -0.5, 0.7);
    Vector18 rigid;
    for (int k = 0; k < 3; ++k) {
        rigid.segment<3>(6 * k) = Eigen::Vector3d(1, 2, 3) + turn.cross(Eigen::Vector3d(corners.row(k)));
        rigid.segment<3>(6 * k + 3) = turn;
    }
    EXPECT_LT((stiffness * rigid).norm(), 1e-12 * values[17]);
}

TEST_F(ShellElement, SharesTheMembraneWithTheSkin) {
    const Matrix18 stiffness = shell_stiffness(triangle, material);
    const Matrix9 membrane = membrane_stiffness(triangle, 1e6, 0.3, 1e-3);
    const Eigen::Matrix2d in_plane = triangle.axes * stiffness.block<3, 3>(0, 6) * triangle.axes.transpose();
    const Eigen::Matrix2d skin = triangle.axes * membrane.block<3, 3>(0, 3) * triangle.axes.transpose();
    EXPECT_LT((in_plane - skin).norm(), 1e-12 * skin.norm());
}

TEST_F(ShellElement, BothMassesWeighTheTriangle) {
    for (MassKind kind : {MassKind::lumped, MassKind::consistent}) {
        const Matrix18 mass = shell_mass(triangle, material, kind);
        EXPECT_LT((mass - mass.transpose()).norm(), 1e-20);
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix18>(mass).eigenvalues()[0], -1e-20);
        Vector18 shift = Vector18::Zero();
        for (int k = 0; k < 3; ++k) {
            shift[6 * k + 1] = 1;
        }
        EXPECT_NEAR(shift.dot(mass * shift), triangle.area, 1e-15);
    }
}

class ShellCase : public testing::Test {
protected:
    ShellModel make(const std::vector<bool>& held) const {
        return {plate.vertices, plate.triangles, material, held};
    }
    std::string message_of(const std::vector<bool>& held) const {
        try {
            make(held).solve(Eigen::MatrixXd::Zero(54, 1));
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "";
    }
    std::vector<bool> clamped() const {
        std::vector<bool> held(54, false);
        for (int v : {0, 3, 6}) {
            std::fill_n(held.begin() + 6 * v, 6, true);
        }
        return held;
    }

    Shell plate = make_rectangle(0.1, 0.1, 2, 2);
    ShellMaterial material{1e6, 0.3, 1e-3, 1000};
};

TEST_F(ShellCase, HeldUnknownsStayAndTheOthersBalanceTheLoad) {
    const std::vector<bool> held = clamped();
    const ShellModel shell = make(held);
    const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(54, -1, 1);
    const Eigen::VectorXd u = shell.solve(force);
    const Eigen::VectorXd reaction = shell.stiffness() * u - force;
    for (int i = 0; i < 54; ++i) {
        if (held[i]) {
            EXPECT_EQ(u[i], 0);
        } else {
            EXPECT_LT(std::abs(reaction[i]), 1e-9);
        }
    }
}

TEST_F(ShellCase, LumpedAndConsistentTonesAreNear) {
    const ShellModel shell = make(clamped());
    const Eigen::VectorXd lumped = shell.frequencies(2, MassKind::lumped);
    const Eigen::VectorXd consistent = shell.frequencies(2, MassKind::consistent);
    EXPECT_GT(lumped[1], lumped[0]);
    EXPECT_GT(lumped[0], 0);
    EXPECT_NEAR(consistent[0] / lumped[0], 1, 0.1);
}

TEST_F(ShellCase, BadInputIsNamed) {
    EXPECT_NE(message_of(std::vector<bool>(54, false)).find("move freely"), std::string::npos);
    EXPECT_NE(message_of(std::vector<bool>(54, true)).find("is held"), std::string::npos);
    EXPECT_NE(message_of(std::vector<bool>(9, false)).find("held has 9 flags"), std::string::npos);
    material.thickness = 0;
    EXPECT_NE(message_of(clamped()).find("thickness is 0"), std::string::npos);
    material.thickness = 1e-3;
    EXPECT_THROW(make(clamped()).frequencies(0, MassKind::lumped), InvalidInput);
}

}  // namespace
}  // namespace mimetic
