// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// basis^T nodal basis for a basis (N x C) that acts on x, y and z alike: 3C x 3C, both triangles.
/// nodal: 3N x 3N, symmetric, xyz interleaved, whose entries come in whole 3 x 3 blocks.
Eigen::SparseMatrix<double> galerkin_product(const Eigen::SparseMatrix<double>& nodal,
                                             const SparseRows& basis);

}  // namespace mimetic
