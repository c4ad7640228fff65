// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/types.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

/// Shapes of a numpy array (M, K, 3) as rows of 3K; throws InvalidInput for another shape.
inline Eigen::Map<const MatrixRows> stack_of(const DoubleArray& array, const char* name) {
    if (array.ndim() != 3 || array.shape(2) != 3) {
        throw InvalidInput(std::string(name) + " must have the shape (M, K, 3)");
    }
    return {array.data(), array.shape(0), 3 * array.shape(1)};
}

/// The inverse of stack_of, without a copy.
inline pybind11::array_t<double> array_of_stack(MatrixRows stack) {
    auto* owned = new MatrixRows(std::move(stack));
    const pybind11::capsule owner(owned, [](void* pointer) { delete static_cast<MatrixRows*>(pointer); });
    return pybind11::array_t<double>({owned->rows(), owned->cols() / 3, Eigen::Index{3}}, owned->data(),
                                     owner);
}

/// Indices as a numpy array.
inline pybind11::array_t<int> array_of(const std::vector<int>& values) {
    return pybind11::array_t<int>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

}  // namespace mimetic::bindings
