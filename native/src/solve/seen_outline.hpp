// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "face_state.hpp"
#include "face_surface.hpp"

namespace mimetic {

/// Where a frame shows the outline of jaw and cheeks before what is behind the head: K points of the
/// skin whose normal is square to the line of sight (the occluding contour), and the pixels in which their
/// outline is seen. Their information is of one direction each, across the outline: along it nothing is
/// measured [Cipolla and Blake 1992, the aperture problem of apparent contours].
/// Left out: what lies before other skin, as a nose before a cheek or a chin before the neck; where the
/// colours on the two sides are alike, or no single edge parts them.
SkinObservations seen_outline(const FaceSurface& surface, const Camera& camera, const FaceState& state,
                              const ColorView& image);

}  // namespace mimetic
