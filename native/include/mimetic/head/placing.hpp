// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/head/head.hpp>
#include <vector>

namespace mimetic {

/// Poses by a simple model of the head (camera from head, metres), put where the person's own skin has them.
///
/// Flow hardly tells a flat head that turns far from a deep one that turns less, and no ellipsoid has the
/// relief of a face: it overturns, much by the same share wherever it looks the same way. Where the reference
/// textures are is known on both models (views); between them the difference is interpolated by a Gaussian
/// process over the head's direction [Rasmussen and Williams 2006, chapter 2]. How far the differences are
/// trusted is what makes them most likely (their section 5.4.1): those of expressions have no order. Throws
/// InvalidInput without views.
std::vector<Eigen::Isometry3d> place_poses(const std::vector<Eigen::Isometry3d>& poses,
                                           const std::vector<PlacedView>& views);

}  // namespace mimetic
