// SPDX-License-Identifier: GPL-3.0-or-later
#include "corotational_element.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace mimetic {

TurnedTriangle::TurnedTriangle(const SkinTriangle& rest, const Eigen::Matrix3d& corners) {
    const Eigen::Matrix<double, 3, 2> gradient = corners * rest.slope.transpose();
    const Eigen::Matrix2d square = gradient.transpose() * gradient;
    const double area_ratio = std::sqrt(std::max(square.determinant(), 0.0));
    crushed = !(area_ratio > 1e-6);
    if (crushed) {
        return;
    }
    // Square root of a symmetric 2 x 2 matrix by its invariants
    stretch =
        (square + area_ratio * Eigen::Matrix2d::Identity()) / std::sqrt(square.trace() + 2 * area_ratio);
    axes = gradient * stretch.inverse();
    normal = Eigen::Vector3d(axes.col(0)).cross(Eigen::Vector3d(axes.col(1)));
}

Eigen::Matrix3d TurnedTriangle::rotation(const SkinTriangle& rest) const {
    return axes * rest.axes + normal * rest.normal.transpose();
}

Eigen::Matrix3d TurnedTriangle::rotation_of(const SkinTriangle& rest, int i) const {
    const Eigen::Vector2d slope = rest.slope.col(i);
    const Eigen::Vector3d spin = (slope[0] * axes.col(1) - slope[1] * axes.col(0)) / stretch.trace();
    const Eigen::Vector2d lift = stretch.inverse() * slope;
    const Eigen::Vector3d tilt = lift[1] * axes.col(0) - lift[0] * axes.col(1);
    return normal * spin.transpose() + tilt * normal.transpose();
}

MembraneState::MembraneState(const Eigen::Matrix2d& stretch, double young, double poisson) {
    const Eigen::Matrix2d strain = stretch - Eigen::Matrix2d::Identity();
    const double modulus = young / (1 - poisson * poisson);
    stress = modulus * ((1 - poisson) * strain + poisson * strain.trace() * Eigen::Matrix2d::Identity());
    energy = stress.cwiseProduct(strain).sum() / 2;
    const double half = stretch.trace() / 2;
    const double shortest = half - std::sqrt(std::max(half * half - stretch.determinant(), 0.0));
    if (shortest < kStiffens) {
        add_compression(stretch, modulus);
    }
}

void MembraneState::add_compression(const Eigen::Matrix2d& stretch, double modulus) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal;
    principal.computeDirect(stretch);
    for (int k = 0; k < 2; ++k) {
        const double length = principal.eigenvalues()[k];
        if (length < kStiffens) {
            const double over = length - kStiffens;
            const double log = std::log(length / kStiffens);
            const Eigen::Vector2d direction = principal.eigenvectors().col(k);
            energy -= modulus * over * over * log;
            stress -= modulus * (2 * over * log + over * over / length) * direction * direction.transpose();
        }
    }
}

}  // namespace mimetic
