// SPDX-License-Identifier: GPL-3.0-or-later
#include "elements.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace mimetic {
namespace {

/// Rotation vector of the triangle for a displacement of corner `i`.
Eigen::Matrix3d rotation_of(const SkinTriangle& t, int i) {
    const Eigen::Vector3d turned = t.normal.cross(Eigen::Vector3d(t.axes.transpose() * t.slope.col(i)));
    return t.normal * turned.transpose() / 2 - turned * t.normal.transpose();
}

}  // namespace

SkinTriangle make_skin_triangle(PointsIn vertices, const Eigen::RowVector3i& face) {
    SkinTriangle t;
    for (int k = 0; k < 3; ++k) {
        t.corners.col(k) = vertices.row(face[k]);
    }
    const Eigen::Vector3d ab = t.corners.col(1) - t.corners.col(0);
    const Eigen::Vector3d cross = ab.cross(Eigen::Vector3d(t.corners.col(2) - t.corners.col(0)));
    t.area = cross.norm() / 2;
    t.normal = cross.normalized();
    t.axes.row(0) = ab.normalized();
    t.axes.row(1) = t.normal.cross(Eigen::Vector3d(t.axes.row(0)));
    const Eigen::Matrix<double, 2, 3> p = t.axes * t.corners;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        t.slope.col(i) << p(1, j) - p(1, k), p(0, k) - p(0, j);
    }
    t.slope /= 2 * t.area;
    return t;
}

Eigen::Matrix3d plane_stress(double young, double poisson) {
    Eigen::Matrix3d elastic;
    elastic << 1, poisson, 0, poisson, 1, 0, 0, 0, (1 - poisson) / 2;
    elastic *= young / (1 - poisson * poisson);
    return elastic;
}

Eigen::Matrix<double, 3, 9> membrane_strain(const SkinTriangle& t) {
    Eigen::Matrix<double, 3, 9> strain;
    for (Eigen::Index k = 0; k < 3; ++k) {
        Eigen::Matrix<double, 3, 2> plane;
        plane << t.slope(0, k), 0, 0, t.slope(1, k), t.slope(1, k), t.slope(0, k);
        strain.middleCols<3>(3 * k) = plane * t.axes;
    }
    return strain;
}

Matrix9 membrane_stiffness(const SkinTriangle& t, double young, double poisson, double thickness) {
    const Eigen::Matrix<double, 3, 9> strain = membrane_strain(t);
    return t.area * thickness * strain.transpose() * plane_stress(young, poisson) * strain;
}

Matrix9 pre_stress_stiffness(const SkinTriangle& t, double tension) {
    const Eigen::Matrix3d coupling = tension * t.area * t.slope.transpose() * t.slope;
    const Eigen::Matrix3d outwards = t.normal * t.normal.transpose();
    Matrix9 stiffness;
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
            stiffness.block<3, 3>(3 * i, 3 * j) = coupling(i, j) * outwards;
        }
    }
    return stiffness;
}

Eigen::Matrix3d foundation_stiffness(double area, const Eigen::Vector3d& n, double tangential,
                                     double across) {
    return area * (tangential * Eigen::Matrix3d::Identity() + (across - tangential) * n * n.transpose());
}

double bending_stiffness(double vertex_area, double young, double poisson, double thickness) {
    const double plate = young * std::pow(thickness, 3) / 12 / (1 - poisson * poisson);
    return plate / vertex_area;
}

Eigen::Matrix3d curvature_share(const SkinTriangle& t) {
    return t.area * t.slope.transpose() * t.slope * t.corners.transpose();
}

Eigen::Matrix<double, 1, 9> curvature_row(const SkinTriangle& t, int i, const Eigen::RowVector3d& normal,
                                          const Eigen::RowVector3d& curvature, double vertex_area) {
    const Eigen::Matrix3d cotangent = t.area * t.slope.transpose() * t.slope;
    const Eigen::RowVector3d tilt = curvature.cross(normal) * (t.area / 3 / vertex_area);
    Eigen::Matrix<double, 1, 9> row;
    for (int j = 0; j < 3; ++j) {
        row.segment<3>(3 * j) = cotangent(i, j) * normal - tilt * rotation_of(t, j);
    }
    return row;
}

double lumped_mass(const SkinTriangle& t, double surface_density) { return surface_density * t.area / 3; }

Matrix9 consistent_mass(const SkinTriangle& t, double surface_density) {
    Matrix9 mass;
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
            mass.block<3, 3>(3 * i, 3 * j) =
                surface_density * t.area * (i == j ? 2 : 1) / 12 * Eigen::Matrix3d::Identity();
        }
    }
    return mass;
}

}  // namespace mimetic
