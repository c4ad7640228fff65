// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/overlay.hpp>

namespace mimetic {

/// A camera at the same place that looks the same way, through another lens: a part of its picture, enlarged.
/// centre: the pixel that its middle shows; scale: its pixels for one of the camera's. Throws InvalidInput.
Camera reframed(const Camera& camera, const Eigen::Vector2d& centre, double scale, int width, int height);

/// What a camera's picture looks like through another lens (`reframed`); black where it does not reach.
/// Throws InvalidInput if the image has not the camera's size.
ColorImage reframed(const ColorView& image, const Camera& camera, const Camera& other);

}  // namespace mimetic
