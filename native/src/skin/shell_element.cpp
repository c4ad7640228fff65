// SPDX-License-Identifier: GPL-3.0-or-later
#include "shell_element.hpp"

#include <array>
#include <cmath>

namespace mimetic {
namespace {

/// Of the side from corner j to corner i: terms of the rotations along it (Batoz, Bathe and Ho 1980).
struct Side {
    double p = 0, t = 0, q = 0, r = 0;
};

struct Plane {
    Eigen::Matrix<double, 2, 3> points;  // corners in the element's axes
    Side s4, s5, s6;                     // opposite to corners 0, 1, 2
};

Plane make_plane(const SkinTriangle& triangle) {
    Plane plane;
    plane.points = triangle.axes * triangle.corners;
    const auto side = [&](int i, int j) -> Side {
        const Eigen::Vector2d d = plane.points.col(i) - plane.points.col(j);
        const double l2 = d.squaredNorm();
        return {-6 * d.x() / l2, -6 * d.y() / l2, 3 * d.x() * d.y() / l2, 3 * d.y() * d.y() / l2};
    };
    plane.s4 = side(1, 2);
    plane.s5 = side(2, 0);
    plane.s6 = side(0, 1);
    return plane;
}

using Row9 = Eigen::Matrix<double, 1, 9>;

/// Derivatives of the rotation fields by the unit triangle's coordinates.
struct RotationSlopes {
    Row9 x_xi, y_xi, x_eta, y_eta;
};

RotationSlopes rotation_slopes(const Plane& plane, double xi, double eta) {
    const auto& [p4, t4, q4, r4] = plane.s4;
    const auto& [p5, t5, q5, r5] = plane.s5;
    const auto& [p6, t6, q6, r6] = plane.s6;
    const double a = 1 - 2 * xi;
    const double b = 1 - 2 * eta;
    RotationSlopes h;
    h.x_xi << p6 * a + (p5 - p6) * eta, q6 * a - (q5 + q6) * eta,
        -4 + 6 * (xi + eta) + r6 * a - eta * (r5 + r6), -p6 * a + eta * (p4 + p6), q6 * a - eta * (q6 - q4),
        -2 + 6 * xi + r6 * a + eta * (r4 - r6), -eta * (p5 + p4), eta * (q4 - q5), -eta * (r5 - r4);
    h.y_xi << t6 * a + eta * (t5 - t6), 1 + r6 * a - eta * (r5 + r6), -q6 * a + eta * (q5 + q6),
        -t6 * a + eta * (t4 + t6), -1 + r6 * a + eta * (r4 - r6), -q6 * a - eta * (q4 - q6), -eta * (t4 + t5),
        eta * (r4 - r5), -eta * (q4 - q5);
    h.x_eta << -p5 * b - xi * (p6 - p5), q5 * b - xi * (q5 + q6),
        -4 + 6 * (xi + eta) + r5 * b - xi * (r5 + r6), xi * (p4 + p6), xi * (q4 - q6), -xi * (r6 - r4),
        p5 * b - xi * (p4 + p5), q5 * b + xi * (q4 - q5), -2 + 6 * eta + r5 * b + xi * (r4 - r5);
    h.y_eta << -t5 * b - xi * (t6 - t5), 1 + r5 * b - xi * (r5 + r6), -q5 * b + xi * (q5 + q6),
        xi * (t4 + t6), xi * (r4 - r6), -xi * (q4 - q6), t5 * b - xi * (t4 + t5),
        -1 + r5 * b + xi * (r4 - r5), -q5 * b - xi * (q4 - q5);
    return h;
}

}  // namespace

Eigen::Matrix<double, 3, 9> plate_curvature(const SkinTriangle& triangle, double xi, double eta) {
    const Plane plane = make_plane(triangle);
    const Eigen::Vector2d d31 = plane.points.col(2) - plane.points.col(0);
    const Eigen::Vector2d d12 = plane.points.col(0) - plane.points.col(1);
    const RotationSlopes h = rotation_slopes(plane, xi, eta);
    Eigen::Matrix<double, 3, 9> curvature;
    curvature.row(0) = d31.y() * h.x_xi + d12.y() * h.x_eta;
    curvature.row(1) = -d31.x() * h.y_xi - d12.x() * h.y_eta;
    curvature.row(2) = -d31.x() * h.x_xi - d12.x() * h.x_eta + d31.y() * h.y_xi + d12.y() * h.y_eta;
    return curvature / (2 * triangle.area);
}

Matrix9 plate_stiffness(const SkinTriangle& triangle, const ShellMaterial& m) {
    const Eigen::Matrix3d flexural = plane_stress(m.young, m.poisson) * std::pow(m.thickness, 3) / 12;
    Matrix9 stiffness = Matrix9::Zero();
    constexpr std::array<std::array<double, 2>, 3> kMiddles{{{0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
    for (const auto& [xi, eta] : kMiddles) {
        const Eigen::Matrix<double, 3, 9> curvature = plate_curvature(triangle, xi, eta);
        stiffness += triangle.area / 3 * curvature.transpose() * flexural * curvature;
    }
    return stiffness;
}

Matrix18 shell_stiffness(const SkinTriangle& triangle, const ShellMaterial& m) {
    const Matrix9 membrane = membrane_stiffness(triangle, m.young, m.poisson, m.thickness);
    Eigen::Matrix<double, 9, 18> plate_from_shell = Eigen::Matrix<double, 9, 18>::Zero();
    Eigen::Matrix<double, 3, 18> spin_from_shell = Eigen::Matrix<double, 3, 18>::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
        plate_from_shell.block<1, 3>(3 * k, 6 * k) = triangle.normal.transpose();
        plate_from_shell.block<2, 3>(3 * k + 1, 6 * k + 3) = triangle.axes;
        spin_from_shell.block<1, 3>(k, 6 * k + 3) = triangle.normal.transpose();
    }
    Matrix18 stiffness = plate_from_shell.transpose() * plate_stiffness(triangle, m) * plate_from_shell;
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
            stiffness.block<3, 3>(6 * i, 6 * j) += membrane.block<3, 3>(3 * i, 3 * j);
        }
    }
    // Flat elements have no stiffness against rotation about the normal (drilling); one without effect on
    // rigid motion is added.
    const Eigen::Matrix3d unlike = 1.5 * Eigen::Matrix3d::Identity() - 0.5 * Eigen::Matrix3d::Ones();
    return stiffness + 1e-3 * m.young * m.thickness * triangle.area * spin_from_shell.transpose() * unlike *
                           spin_from_shell;
}

Matrix18 shell_mass(const SkinTriangle& triangle, const ShellMaterial& m, MassKind kind) {
    const double surface_density = m.density * m.thickness;
    const Matrix9 translation = kind == MassKind::consistent
                                    ? consistent_mass(triangle, surface_density)
                                    : Matrix9(lumped_mass(triangle, surface_density) * Matrix9::Identity());
    const double rotary = surface_density * m.thickness * m.thickness / 12 * triangle.area / 3;
    Matrix18 mass = Matrix18::Zero();
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
            mass.block<3, 3>(6 * i, 6 * j) = translation.block<3, 3>(3 * i, 3 * j);
        }
        mass.block<3, 3>(6 * i + 3, 6 * i + 3) = rotary * Eigen::Matrix3d::Identity();
    }
    return mass;
}

}  // namespace mimetic
