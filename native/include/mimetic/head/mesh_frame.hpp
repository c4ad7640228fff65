// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Whether a mesh's points went elsewhere all together, as when a program applies an object's transform to
/// them: what was noted in the frame of before goes along then.

/// `count` vertices that lie far from each other; four would do, more of them average what rounding adds.
/// points: V x 3, at least one; where there are fewer than `count`, the first mark fills what is left.
std::vector<int> marks_of(PointsIn points, int count);

/// 4 x 4, by which marks (K x 3) went from where they were noted to where they are now: the identity if they
/// stayed, did not go all together, or lie in a plane. Coordinates have the accuracy of single precision.
Eigen::Matrix4d now_from_noted(PointsIn noted, PointsIn now);

}  // namespace mimetic
