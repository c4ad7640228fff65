// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "../../../native/src/skin/skin_assembly.hpp"

namespace mimetic {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

class SkinElement : public testing::Test {
protected:
    SkinElement() {
        corners << 0.011, 0.002, -0.004, 0.019, 0.005, 0.003, 0.008, 0.013, 0.001;
        triangle = make_skin_triangle(corners, {0, 1, 2});
    }

    /// Smallest and largest eigenvalue; fails unless symmetric.
    static Eigen::Vector2d spectrum(const Matrix9& matrix) {
        EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-14 * matrix.norm());
        const Vector9 values = Eigen::SelfAdjointEigenSolver<Matrix9>(matrix).eigenvalues();
        return {values[0], values[8]};
    }

    static int null_space(const Matrix9& matrix) {
        const Vector9 values = Eigen::SelfAdjointEigenSolver<Matrix9>(matrix).eigenvalues();
        return static_cast<int>((values.array().abs() < 1e-12 * values[8]).count());
    }

    Vector9 moved(const Eigen::Matrix3d& gradient, const Eigen::Vector3d& shift) const {
        Vector9 u;
        for (int k = 0; k < 3; ++k) {
            u.segment<3>(3 * k) = gradient * corners.row(k).transpose() + shift;
        }
        return u;
    }

    /// Gradient of a small rotation about an axis that is none of the element's.
    static Eigen::Matrix3d turn() {
        Eigen::Matrix3d gradient;
        gradient << 0, -0.3, 0.5, 0.3, 0, -0.7, -0.5, 0.7, 0;
        return gradient;
    }

    Points corners{3, 3};
    SkinTriangle triangle;
};

TEST_F(SkinElement, MembraneResistsThreeStrainsAndNoRigidMotion) {
    const Matrix9 stiffness = membrane_stiffness(triangle, 40e3, 0.49, 1.5e-3);
    const Eigen::Vector2d range = spectrum(stiffness);
    EXPECT_GT(range[0], -1e-14 * range[1]);
    EXPECT_EQ(null_space(stiffness), 6);  // three strains: the only ones it has
    EXPECT_LT((stiffness * moved(turn(), {1, 2, 3})).norm(), 1e-13 * range[1]);
}

TEST_F(SkinElement, MembraneStoresTheEnergyOfPlaneStress) {
    Eigen::Matrix2d strain;
    strain << 2e-3, 4e-4, 4e-4, -1e-3;
    const Eigen::Matrix3d gradient = triangle.axes.transpose() * strain * triangle.axes;
    const Vector9 u = moved(gradient, Eigen::Vector3d::Zero());
    EXPECT_LT((membrane_strain(triangle) * u - Eigen::Vector3d(2e-3, -1e-3, 8e-4)).norm(), 1e-15);
    const double nu = 0.3;
    const double density =
        5e3 / (1 - nu * nu) / 2 * (4e-6 + 1e-6 + 2 * nu * 2e-3 * -1e-3 + (1 - nu) / 2 * 8e-4 * 8e-4);
    const double energy = u.dot(membrane_stiffness(triangle, 5e3, nu, 2e-3) * u) / 2;
    EXPECT_NEAR(energy, density * 2e-3 * triangle.area, 1e-12 * energy);
}

TEST_F(SkinElement, PreStressResistsTiltOnly) {
    const double tension = 30;
    const Matrix9 stiffness = pre_stress_stiffness(triangle, tension);
    const Eigen::Vector2d range = spectrum(stiffness);
    EXPECT_GT(range[0], -1e-14 * range[1]);
    EXPECT_EQ(null_space(stiffness), 7);  // everything within the plane, and one motion out of it
    // Half the tension times the area times the square of the slope.
    const Eigen::Matrix3d tilt = triangle.normal * 0.1 * triangle.axes.row(1);
    const Vector9 u = moved(tilt, {1, 2, 3});
    EXPECT_NEAR(u.dot(stiffness * u) / 2, tension * triangle.area * 0.01 / 2, 1e-14);
}

TEST_F(SkinElement, FoundationHasItsTwoStiffnesses) {
    const Eigen::Matrix3d stiffness = foundation_stiffness(2e-5, triangle.normal, 1e5, 1e6);
    EXPECT_LT((stiffness * triangle.normal - 20 * triangle.normal).norm(), 1e-12);
    const Eigen::Vector3d along = triangle.axes.row(0);
    EXPECT_LT((stiffness * along - 2 * along).norm(), 1e-12);
}

TEST_F(SkinElement, MassesMoveAsOneAndAgreeInTotal) {
    const double density = 1100 * 1.5e-3;
    const Matrix9 consistent = consistent_mass(triangle, density);
    EXPECT_GT(spectrum(consistent)[0], 0);
    const double lumped = lumped_mass(triangle, density);
    EXPECT_NEAR(3 * lumped, density * triangle.area, 1e-18);
    const Vector9 shift = moved(Eigen::Matrix3d::Zero(), {1, -2, 2});
    EXPECT_NEAR(shift.dot(consistent * shift), density * triangle.area * 9, 1e-15);
    EXPECT_NEAR(consistent.row(0).sum(), lumped, 1e-18);  // lumping is summing the rows
}

TEST_F(SkinElement, ConsistentMassHasTheEnergyOfALinearField) {
    // The middles of the sides integrate a quadratic exactly.
    const Vector9 velocity = moved(turn(), {0.1, 0, -0.2});
    double energy = 0;
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d middle =
            (velocity.segment<3>(3 * k) + velocity.segment<3>(3 * ((k + 1) % 3))) / 2;
        energy += triangle.area / 3 * middle.squaredNorm() / 2;
    }
    EXPECT_NEAR(velocity.dot(consistent_mass(triangle, 1) * velocity) / 2, energy, 1e-14 * energy);
}

TEST(SkinAssembly, TurningACurvedPatchBendsNothing) {
    Points vertices(7, 3);  // a hexagonal cap around vertex 0
    Triangles triangles(6, 3);
    vertices.row(0) << 0, 0, 0.003;
    for (int k = 0; k < 6; ++k) {
        const double angle = k + 0.1 * std::sin(9.0 * k);
        vertices.row(k + 1) << 0.01 * std::cos(angle), 0.012 * std::sin(angle), 0;
        triangles.row(k) << 0, k + 1, (k + 1) % 6 + 1;
    }
    const std::vector<SkinTriangle> elements = make_skin_triangles(vertices, triangles);
    const VertexLists rings = vertex_rings(triangles, 7);
    const Points change = curvature_change(elements, triangles, make_frames(elements, triangles, 7), rings);
    ASSERT_EQ(rings.of(0).size(), 7);
    const auto of_middle = change.topRows<7>();  // the whole patch is its ring
    Points turned(7, 3);
    for (int axis = 0; axis < 3; ++axis) {
        for (int v = 0; v < 7; ++v) {
            turned.row(v) = Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(vertices.row(v)));
        }
        EXPECT_LT(std::abs(of_middle.cwiseProduct(turned).sum()), 1e-14);
    }
    EXPECT_GT(std::abs(of_middle(0, 2)), 1);  // and a bump does
}

}  // namespace
}  // namespace mimetic
