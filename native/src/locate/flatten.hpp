// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace mimetic::locate {

cv::Mat1f float_image(GrayView image);
MatrixRows values_of(const cv::Mat1f& values);

/// Grey values less their surroundings' mean, in their surroundings' deviations.
/// ipd_px: the pupil distance that is looked for, pixels; the surroundings grow with it.
cv::Mat1f flatten(const cv::Mat1f& gray, double ipd_px);

/// An image and its halves, for windows of any size without aliasing.
class Pyramid {
public:
    explicit Pyramid(const cv::Mat1f& gray);
    const cv::Mat1f& image() const { return halves_[0]; }
    const cv::Mat1f& not_below(double scale) const;  ///< the smallest half that is no coarser
    /// A window, cols x rows, round a pixel of the image.
    cv::Mat1f cut(const Eigen::Vector2d& center, double image_px_per_px, double roll, cv::Size size) const;
    /// A flattened window, cols x rows, round a pixel of the image.
    cv::Mat1f window(const Eigen::Vector2d& center, double image_px_per_px, double roll, cv::Size size,
                     double ipd_px) const;

private:
    std::vector<cv::Mat1f> halves_;
};

struct Level {
    cv::Mat1f flat;
    double width = 0;                            ///< of a window, pixels of the image
    Eigen::Array2d px = Eigen::Array2d::Ones();  ///< pixels of the image in one of the level's
};

/// Sizes in geometric steps; a level that no window fits into is left out.
std::vector<Level> levels(const Pyramid& pyramid, int side, double smallest, double largest,
                          int steps_per_octave);

}  // namespace mimetic::locate
