// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic {

/// The rims of glasses that a head wears: curves along their lower halves and the bridge, each N x 3, head
/// frame, metres. Empty where it wears none, or none whose rims can be seen.
///
/// A rim is a dark or a bright line, narrow and without gaps, below each eye and over the nose between them:
/// folds and bags below the eyes are softer, and no line crosses the bridge of a bare nose.
/// eyes: 2 x 3, centres of the eyeballs, head frame, metres, the subject's left one first.
/// Throws InvalidInput if the picture is not the camera's size.
std::vector<Points> glasses_rims(const ColorView& image, const Camera& camera,
                                 const Eigen::Isometry3d& camera_from_head, const Points& eyes);

}  // namespace mimetic
