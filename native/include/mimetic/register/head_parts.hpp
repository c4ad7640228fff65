// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Points (V x 3) of a part of a head, an eyeball for instance, in the head's frame. Throws InvalidInput if
/// the matrix is not finite or flattens the part.
Points placed_points(PointsIn points, const Eigen::Matrix4d& head_from_part);

/// Displacements (V x 3) in the head's frame as the part's own has them. Throws InvalidInput likewise.
Points moved_in_part(PointsIn displacements, const Eigen::Matrix4d& head_from_part);

/// Whether the part's frame is a mirror image of the head's, so that its faces look inwards there.
bool is_mirror(const Eigen::Matrix4d& head_from_part);

/// Whether points (P x 3) lie inside of the box about a head's (V x 3), or hardly outside, and are together
/// less than half as large.
bool lies_in_box(PointsIn head, PointsIn part);

}  // namespace mimetic
