// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// The middle of what a displacement field moves: points (V x 3) weighted by the squares of their
/// displacements (V x 3). The points' own middle where nothing moves. Throws InvalidInput for no points, or
/// other numbers.
Eigen::RowVector3d centre_of_motion(PointsIn points, PointsIn displacements);

}  // namespace mimetic
