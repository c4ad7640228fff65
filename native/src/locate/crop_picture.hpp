// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/feature_crops.hpp>
#include <mimetic/shared/image.hpp>
#include <opencv2/core.hpp>

namespace mimetic::locate {

/// The crop as a network takes it: 1 x 3 x side x side, red green blue in 0 to 1. What lies beside the
/// picture repeats its border. Throws InvalidInput for a crop of which nothing is in the picture.
cv::Mat blob_of(ColorView image, const FeatureCrop& crop, int side, bool mirrored);

/// The same of mean 0 and deviation 1, as networks of our own take it: light and contrast of a picture tell
/// them nothing.
cv::Mat standardised(const cv::Mat& blob);

/// Pixels of the picture of points in sides of the crop.
Points2 in_picture(const Points2& shares, const FeatureCrop& crop, bool mirrored);

/// The reverse for one pixel, not mirrored: 0 to 1 along both sides within the crop.
Eigen::Vector2d in_crop(const Eigen::Vector2d& pixel, const FeatureCrop& crop);

}  // namespace mimetic::locate
