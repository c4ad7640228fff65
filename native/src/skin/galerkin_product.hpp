// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

#include "block_rows.hpp"

namespace mimetic {

/// basis^T nodal basis for a basis (N x C) that acts on x, y and z alike: 3C x 3C, both triangles.
Eigen::SparseMatrix<double> galerkin_product(const BlockRows& nodal, const SparseRows& basis);

}  // namespace mimetic
