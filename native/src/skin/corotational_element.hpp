// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "elements.hpp"

namespace mimetic {

/// A triangle that has moved: its deformation gradient F = Q S (3 x 2, from its plane at rest).
struct TurnedTriangle {
    Eigen::Matrix<double, 3, 2> axes;  ///< Q, columns: the element's rotated axes
    Eigen::Vector3d normal;            ///< unit
    Eigen::Matrix2d stretch;           ///< S, symmetric
    bool crushed = false;              ///< no area is left: the other fields are undefined

    /// `corners`: columns, metres, where those of `rest` are now.
    TurnedTriangle(const SkinTriangle& rest, const Eigen::Matrix3d& corners);

    Eigen::Matrix3d rotation(const SkinTriangle& rest) const;
    /// Rotation vector of the triangle for a displacement of corner `i` from here.
    Eigen::Matrix3d rotation_of(const SkinTriangle& rest, int i) const;
};

/// Membrane energy over area and thickness, J/m^3, and the stress along the turned axes, Pa. Linear in the
/// stretch down to 0.6 of the length at rest; from there a barrier -(s - 0.6)^2 log(s / 0.6) times the
/// modulus keeps dead loads from crushing triangles to lines, as tissue that keeps its volume would.
struct MembraneState {
    static constexpr double kStiffens = 0.6;

    double energy = 0;
    Eigen::Matrix2d stress;
    MembraneState(const Eigen::Matrix2d& stretch, double young, double poisson);

private:
    void add_compression(const Eigen::Matrix2d& stretch, double modulus);
};

}  // namespace mimetic
