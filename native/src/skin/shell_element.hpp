// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/skin/shell.hpp>

#include "elements.hpp"

namespace mimetic {

/// Three corners, each with its displacement and its rotation vector, world axes.
using Matrix18 = Eigen::Matrix<double, 18, 18>;

/// Curvature (w,xx w,yy 2w,xy, negative) in the element's axes at a point of the unit triangle, for (w, w,y,
/// -w,x) of the three corners.
Eigen::Matrix<double, 3, 9> plate_curvature(const SkinTriangle& triangle, double xi, double eta);

/// Discrete Kirchhoff triangle (Batoz, Bathe and Ho 1980): stiffness over (w, w,y, -w,x) of the corners.
Matrix9 plate_stiffness(const SkinTriangle& triangle, const ShellMaterial& material);

/// Constant-strain membrane, discrete Kirchhoff plate, and a small stiffness against corners that turn
/// about the normal unlike each other.
Matrix18 shell_stiffness(const SkinTriangle& triangle, const ShellMaterial& material);

/// Mass of the displacements, and the small inertia of the thickness against turning.
Matrix18 shell_mass(const SkinTriangle& triangle, const ShellMaterial& material, MassKind kind);

}  // namespace mimetic
