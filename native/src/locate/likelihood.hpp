// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/eigenspace.hpp>
#include <opencv2/core.hpp>

namespace mimetic::locate {

/// The part of the log likelihood that no patch changes.
double log_normalizer(const Eigenspace& space);

/// As likelihood_map, of an image of any range; least_deviation in its unit. Empty if no patch fits.
cv::Mat1f likelihoods(const Eigenspace& space, const cv::Mat1f& image, double least_deviation);

/// Best places of a map (x, y, value), largest first, no two within `apart` pixels; sub-pixel by a parabola.
std::vector<Eigen::Vector3d> summits(const cv::Mat1f& map, int count, double apart);

}  // namespace mimetic::locate
