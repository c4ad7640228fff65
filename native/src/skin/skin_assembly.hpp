// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/skin/skin.hpp>
#include <vector>

#include "block_rows.hpp"
#include "elements.hpp"

namespace mimetic {

using Columns = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

std::vector<SkinTriangle> make_skin_triangles(PointsIn vertices, TrianglesIn triangles);

struct VertexFrames {
    Eigen::VectorXd areas;  ///< a third of the triangles around, m^2
    Points normals;         ///< unit
};

VertexFrames make_frames(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
                         Eigen::Index num_vertices);

/// Adds membrane and pre-stress over the vertices' displacements; the matrix has the vertices' rings.
void add_membrane(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
                  const SkinMaterials& materials, BlockRows& nodal);

/// Attachment of every vertex to the bone, N/m.
std::vector<Eigen::Matrix3d> assemble_foundation(const SkinMaterials& materials, const VertexFrames& frames);

/// One 3 x 3 block a vertex as a matrix, 3N x 3N.
Columns block_diagonal(const std::vector<Eigen::Matrix3d>& blocks);

/// Change of each vertex's mean curvature along its normal times its area, by the displacements of its ring:
/// a row for each vertex of each ring, as in rings.vertex.
Points curvature_change(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
                        const VertexFrames& frames, const VertexLists& rings);

/// Adds bending, for flexures N; the matrix has the vertices' second rings.
void add_bending(const Points& curvature_change, const Eigen::VectorXd& flexures, const VertexLists& rings,
                 BlockRows& nodal);

/// Bending energy is half of this times the square of `curvature_change`; a free edge carries no moment.
Eigen::VectorXd flexure(const SkinMaterials& materials, const VertexFrames& frames,
                        const std::vector<bool>& on_boundary);

/// The basis once for each of x, y, z, interleaved: 3N x 3C.
Columns interleave(const SparseRows& basis);

/// What a SkinModel factors; inputs as there, checked before.
struct SkinMatrices {
    Columns basis;                            ///< 3N x 3C
    Columns stiffness;                        ///< 3C x 3C
    std::vector<Eigen::Matrix3d> foundation;  ///< a vertex, N/m
};

SkinMatrices assemble_skin(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                           const SparseRows& basis, const std::vector<bool>& on_boundary);

}  // namespace mimetic
