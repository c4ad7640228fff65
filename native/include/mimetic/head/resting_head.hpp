// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// World from character (rig_motion.hpp): where a head without landmarks rests in the world, and where it
/// faces, by what its own controls move.
///
/// points: V x 3, the object's frame; starts: of each polygon among `corners` (vertices); moved: V, how much
/// the controls move of each, not negative (all 0: of the whole alike); world_from_object: as the object
/// stands; units: of the world, per metre. A mesh's y may be up in an object that stands turned, so that the
/// character's axes are those of the object's, either way round, of which one is most nearly up and one
/// looks as the face does. A mirrored object holds a face still: its left is where its right was.
/// Throws InvalidInput for a flat object, and polygons that are none.
Eigen::Matrix4d world_from_moved_head(PointsIn points, const std::vector<int>& starts,
                                      const std::vector<int>& corners, VectorIn moved,
                                      const Eigen::Matrix4d& world_from_object, double units);

}  // namespace mimetic
