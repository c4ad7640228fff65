// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

using Matrix9 = Eigen::Matrix<double, 9, 9>;  ///< three corners, xyz interleaved

/// A flat triangle of the skin at rest, with its linear shape functions.
struct SkinTriangle {
    Eigen::Matrix3d corners;            ///< a column a corner, metres
    Eigen::Vector3d normal;             ///< unit
    Eigen::Matrix<double, 2, 3> axes;   ///< its own plane, rows e1 (along the first edge) and e2
    Eigen::Matrix<double, 2, 3> slope;  ///< gradients of the shape functions in that plane, 1/m
    double area = 0;                    ///< m^2
};

SkinTriangle make_skin_triangle(PointsIn vertices, const Eigen::RowVector3i& face);

/// Plane stress over plane strain (exx, eyy, gxy), Pa.
Eigen::Matrix3d plane_stress(double young, double poisson);

/// Plane strain (exx, eyy, gxy) in the element's axes for displacements of its corners.
Eigen::Matrix<double, 3, 9> membrane_strain(const SkinTriangle& triangle);

/// Constant-strain membrane, N/m.
Matrix9 membrane_stiffness(const SkinTriangle& triangle, double young, double poisson, double thickness);

/// Geometric stiffness of an isotropic tension in the plane (N/m: pre-stress times thickness).
Matrix9 pre_stress_stiffness(const SkinTriangle& triangle, double tension);

/// Elastic attachment of one vertex: area in m^2, stiffness along and across the skin in N/m^3 -> N/m.
Eigen::Matrix3d foundation_stiffness(double area, const Eigen::Vector3d& normal, double tangential,
                                     double across);

/// D / A: energy is half of this times the square of `curvature_row`'s sum, 1/m^2 of plate stiffness N m.
double bending_stiffness(double vertex_area, double young, double poisson, double thickness);

/// Mean-curvature vector of the surface times the vertex's area, the triangle's share for its corners (rows).
Eigen::Matrix3d curvature_share(const SkinTriangle& triangle);

/// Change of that curvature along the vertex's normal for displacements of the triangle's corners: the
/// triangle's share for its corner `i`. Turning the surface turns the vector without bending anything, so
/// the mean rotation of the elements around the vertex is subtracted. `curvature`: the vertex's sum of
/// shares.
Eigen::Matrix<double, 1, 9> curvature_row(const SkinTriangle& triangle, int i,
                                          const Eigen::RowVector3d& normal,
                                          const Eigen::RowVector3d& curvature, double vertex_area);

/// Mass of each corner, kg, for a surface density in kg/m^2.
double lumped_mass(const SkinTriangle& triangle, double surface_density);

/// Mass of the linear shape functions, kg.
Matrix9 consistent_mass(const SkinTriangle& triangle, double surface_density);

}  // namespace mimetic
