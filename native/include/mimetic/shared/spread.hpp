// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Rows of a table that lie well apart: `first`, then repeatedly the allowed row farthest from all that are
/// chosen, until there are `count`, or the farthest is nearer than `least`. Of rows equally far the first
/// is taken. Throws InvalidInput where `first` is empty or names no row, or `allowed` has another length.
std::vector<int> spread_rows(MatrixIn rows, const std::vector<int>& first, const std::vector<bool>& allowed,
                             int count, double least = 0);

/// Points of a front view moved apart in x and z, y kept, until no two are nearer than `least` there: each
/// pair that is gives way by equal parts, and what is in the middle (x = 0) stays there, so that what is
/// mirrored stays so. Where there is no room for all they end nearer. Throws InvalidInput for a distance
/// below 0, or points that are not finite.
Points drawn_apart(PointsIn points, double least);

}  // namespace mimetic
