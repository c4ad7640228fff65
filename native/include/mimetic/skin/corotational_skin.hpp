// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/skin/skin.hpp>

namespace mimetic {

struct CorotationalOptions {
    int max_iterations = 500;
    double tolerance = 1e-4;  ///< of the residual force, relative to the load (0.01 mm on a face)

    void check() const;  ///< throws InvalidInput: field, value, limit
};

struct CorotationalSolution {
    Eigen::VectorXd unknowns;  ///< 3C, metres
    int iterations = 0;
    double residual = 0;  ///< norm of the residual force over that of the load
    bool converged = false;
};

/// The skin of SkinModel under large rotations: every triangle's strain is measured in axes that turn with it
/// (polar decomposition), every vertex's curvature along a normal that turns with its triangles. Pre-stress
/// and the attachment to the bone act as in SkinModel, whose stiffness this has at rest.
class CorotationalSkin {
public:
    /// As SkinModel.
    CorotationalSkin(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                     const SparseRows& basis);
    ~CorotationalSkin();
    CorotationalSkin(CorotationalSkin&&) noexcept;
    CorotationalSkin& operator=(CorotationalSkin&&) noexcept;
    CorotationalSkin(const CorotationalSkin&) = delete;
    CorotationalSkin& operator=(const CorotationalSkin&) = delete;

    const SkinModel& linear() const;

    /// Elastic energy, J; infinite where a triangle is crushed to a line.
    double energy(VectorIn unknowns) const;
    /// Its gradient: the forces (3C, newtons) that hold the skin there.
    Eigen::VectorXd gradient(VectorIn unknowns) const;

    /// Equilibrium with forces on the vertices (3N, newtons, xyz interleaved) that keep their directions: a
    /// quasi-Newton descent (L-BFGS) in the metric of the linear stiffness, which is factored once
    /// [Liu, Bouaziz, Kavan 2017], from the linear solution. Throws InvalidInput if nothing holds the skin.
    CorotationalSolution solve(VectorIn forces, const CorotationalOptions& options = {}) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace mimetic
