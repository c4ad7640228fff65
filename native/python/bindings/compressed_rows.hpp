// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <tuple>
#include <type_traits>

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

/// (indptr, indices, weights) of a matrix of compressed rows.
inline pybind11::tuple to_compressed(const SparseRows& matrix) {
    const auto copied = [](const auto* data, Eigen::Index size) {
        return pybind11::array_t<std::remove_cvref_t<decltype(*data)>>(static_cast<pybind11::ssize_t>(size),
                                                                       data);
    };
    return pybind11::make_tuple(copied(matrix.outerIndexPtr(), matrix.outerSize() + 1),
                                copied(matrix.innerIndexPtr(), matrix.nonZeros()),
                                copied(matrix.valuePtr(), matrix.nonZeros()));
}

}  // namespace mimetic::bindings
