// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <mimetic/raster/overlay.hpp>

namespace mimetic {

/// Red, green, blue, 0 to 255: from red (lost) over amber to green-blue (well explained).
Eigen::Vector3f quality_colour(double quality, double held_quality);

/// Frame number and quality (0 to 1, held below `held_quality`) in a dark strip at the lower left of a
/// picture.
void draw_gauge(ColorImage& picture, double quality, double held_quality, int frame);

}  // namespace mimetic
