// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Skin over bone, one value a vertex; triangles take the mean of their corners.
struct SkinMaterials {
    Eigen::VectorXd young;       ///< Pa, small strain
    Eigen::VectorXd poisson;     ///< plane stress, below 1
    Eigen::VectorXd thickness;   ///< m
    Eigen::VectorXd pre_stress;  ///< Pa, isotropic in the tangent plane
    Eigen::VectorXd tangential;  ///< N/m^3, elastic attachment to the bone along the skin
    Eigen::VectorXd normal;      ///< N/m^3, the same across the skin

    void check(Eigen::Index num_vertices) const;  ///< throws InvalidInput: which, where, limit
};

/// Static linear shell: constant-strain membrane, cotangent plate bending, pre-stress and a Winkler
/// foundation. Displacements are `basis` times the unknowns, so that a shell on a refined mesh can be solved
/// for the control vertices of its subdivision surface (Galerkin); a basis of identity gives plain nodal
/// unknowns, dropped columns are held at zero.
class SkinModel {
public:
    /// vertices N x 3, triangles of one connected manifold, basis N x C. Throws InvalidInput, naming the face
    /// or vertex, on a triangle without area or inverted relative to its neighbours, an edge of more than two
    /// triangles, parts that are disconnected or touch in a point.
    SkinModel(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
              const SparseRows& basis);
    ~SkinModel();
    SkinModel(SkinModel&&) noexcept;
    SkinModel& operator=(SkinModel&&) noexcept;
    SkinModel(const SkinModel&) = delete;
    SkinModel& operator=(const SkinModel&) = delete;

    int num_vertices() const;
    int num_unknowns() const;  ///< C points

    /// 3C x 3C, symmetric, xyz interleaved, N/m.
    const Eigen::SparseMatrix<double>& stiffness() const;
    /// 3N x 3C: displacements of the vertices from the unknowns, loads on the unknowns by its transpose.
    const Eigen::SparseMatrix<double>& basis() const;

    /// Forces on the vertices that hold them at `displacements` of the bone under them: N x 3, newtons.
    Points foundation_forces(PointsIn displacements) const;

    /// Loads on the unknowns of forces 3N x M (xyz interleaved, newtons, a column a load case): 3C x M.
    Eigen::MatrixXd loads(const Eigen::Ref<const Eigen::MatrixXd>& forces) const;

    /// Static response: forces as for `loads` -> unknowns 3C x M, metres. Throws InvalidInput if the
    /// stiffness is singular (nothing holds the skin).
    Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& forces) const;

    /// The same for loads on the unknowns themselves, 3C x M.
    Eigen::MatrixXd solve_loads(const Eigen::Ref<const Eigen::MatrixXd>& loads) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace mimetic
