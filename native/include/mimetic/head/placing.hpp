// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/head/head.hpp>
#include <vector>

namespace mimetic {

/// Poses by a simple model of the head (camera from head, metres), corrected to the person's own surface.
///
/// Flow hardly separates a flat head that turns far from a deep one that turns less, and no ellipsoid has the
/// relief of a face: its rotation is overestimated, by a share that depends on the head's direction. The
/// reference textures' poses are known on both models (views); between them the difference is interpolated by
/// a Gaussian process over the head's direction [Rasmussen and Williams 2006, chapter 2]. The noise of the
/// differences maximises their likelihood (section 5.4.1): those due to expressions are independent. Throws
/// InvalidInput without views.
std::vector<Eigen::Isometry3d> place_poses(const std::vector<Eigen::Isometry3d>& poses,
                                           const std::vector<PlacedView>& views);

}  // namespace mimetic
