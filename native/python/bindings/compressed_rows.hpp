// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic::bindings {

/// A sparse matrix as Python holds it: numpy has none, and the casts of pybind11 need scipy.
struct CompressedRows {
    SparseRows matrix;
};

}  // namespace mimetic::bindings
