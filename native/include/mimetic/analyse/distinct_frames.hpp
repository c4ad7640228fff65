// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Rows of a table (N x D) far from each other, rising: the first one given, then repeatedly the usable one
/// that is farthest from all chosen so far [Gonzalez 1985]. usable: N. Throws InvalidInput if there is no
/// such first row.
std::vector<int> distinct_rows(MatrixIn table, const std::vector<bool>& usable, int first, int count);

}  // namespace mimetic
