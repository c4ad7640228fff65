// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

struct ShellMaterial {
    double young = 40e3;        ///< Pa
    double poisson = 0.49;      ///< plane stress, below 1
    double thickness = 1.5e-3;  ///< m
    double density = 1100;      ///< kg/m^3

    void check() const;  ///< throws InvalidInput: which, value, limit
};

enum class MassKind { lumped, consistent };

/// Thin shell with rotations at the vertices: the skin's constant-strain membrane with the discrete Kirchhoff
/// triangle (Batoz, Bathe and Ho 1980) in bending. It carries moments that the skin's own bending leaves out
/// (free and clamped edges, twist), so it is the reference that the skin is checked against, as it is against
/// published shells. Unknowns: displacement x y z (m) and rotation vector x y z (rad) of each vertex, world
/// axes.
class ShellModel {
public:
    /// vertices N x 3, triangles of one connected manifold, held: 6N, true where an unknown stays zero.
    /// Throws InvalidInput, naming the face or vertex.
    ShellModel(PointsIn vertices, TrianglesIn triangles, const ShellMaterial& material,
               const std::vector<bool>& held);
    ~ShellModel();
    ShellModel(ShellModel&&) noexcept;
    ShellModel& operator=(ShellModel&&) noexcept;
    ShellModel(const ShellModel&) = delete;
    ShellModel& operator=(const ShellModel&) = delete;

    /// 6N x 6N, symmetric, nothing held.
    const Eigen::SparseMatrix<double>& stiffness() const;

    /// 6N x 6N, symmetric: kg, and kg m^2 of the thickness against turning.
    const Eigen::SparseMatrix<double>& mass(MassKind kind) const;

    /// Static response: forces and moments 6N x M, N and N m -> 6N x M, m and rad. Throws InvalidInput if
    /// the held unknowns leave the shell free to move.
    Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& forces) const;

    /// The `count` lowest natural frequencies, Hz, rising. Throws as `vibration_modes`.
    Eigen::VectorXd frequencies(int count, MassKind kind) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace mimetic
