// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <tuple>

#include "arrays.hpp"

namespace mimetic::bindings {

/// (indptr, indices, weights), as LimitSurface.stencils() gives them.
using CompressedRows = std::tuple<Eigen::VectorXi, Eigen::VectorXi, Eigen::VectorXd>;

/// Throws InvalidInput unless they are rows of a matrix with that many columns.
inline SparseRows to_sparse(const CompressedRows& rows, int num_columns) {
    const auto& [indptr, indices, weights] = rows;
    const bool fits = indptr.size() > 0 && indptr[0] == 0 && indptr[indptr.size() - 1] == indices.size() &&
                      indices.size() == weights.size() && num_columns > 0 &&
                      (indices.size() == 0 || (indices.minCoeff() >= 0 && indices.maxCoeff() < num_columns));
    bool rises = true;
    for (Eigen::Index i = 1; i < indptr.size(); ++i) {
        rises = rises && indptr[i] >= indptr[i - 1];
    }
    if (!fits || !rises) {
        throw InvalidInput("got no matrix of compressed rows with " + std::to_string(num_columns) +
                           " columns");
    }
    return Eigen::Map<const SparseRows>(indptr.size() - 1, num_columns, indices.size(), indptr.data(),
                                        indices.data(), weights.data());
}

}  // namespace mimetic::bindings
