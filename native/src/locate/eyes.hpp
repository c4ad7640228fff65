// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace mimetic::locate {

struct Iris {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    double score = 0;  ///< 0 to 1, mean squared cosine between gradients and rays of the disc's rim
};

/// How well a dark disc of the given radius (pixels) fits at each pixel: rays from the centre meet the rim's
/// gradients at right angles [Timm and Barth 2011], and the disc is darker than its sides.
cv::Mat1f iris_scores(const cv::Mat1f& luminance, double radius);

/// The best peaks of a score map, best first, at least `apart` pixels from each other.
std::vector<Iris> peaks(const cv::Mat1f& scores, double apart, std::size_t count);

struct EyePair {
    Iris right;  ///< the subject's right: on the image's left
    Iris left;
    double likelihood = 0;
};

/// Pupils in a square crop of a face as Haar cascades box it.
/// eye_boxes: centres of an eye detector's hits in the same crop; they raise the pairs near them.
EyePair find_eyes(const cv::Mat1f& face, const std::vector<Eigen::Vector2d>& eye_hits);

}  // namespace mimetic::locate
