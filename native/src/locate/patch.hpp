// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/LU>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <opencv2/core.hpp>

namespace mimetic::locate {

/// Patch pixels an interpupillary distance (IPD): features have the same size in every patch.
inline constexpr double kIpd = 64;

/// An upright, level picture of one face, with the mid-eye point at a fixed place.
struct FacePatch {
    cv::Mat1f luminance;                                 ///< 0 to 1
    cv::Mat1f redness;                                   ///< log(red / green); 0 in a grey image
    cv::Mat1f blueness;                                  ///< log(blue / green)
    Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();  ///< image_from_patch, rotation and scale
    Eigen::Vector2d mid_eyes = Eigen::Vector2d::Zero();  ///< in the image, pixels

    double image_px_per_ipd() const { return kIpd * turn.col(0).norm(); }
    Eigen::Vector2d to_image(const Eigen::Vector2d& in_ipd) const { return mid_eyes + kIpd * turn * in_ipd; }
    Eigen::Vector2d to_ipd(const Eigen::Vector2d& in_image) const {
        return turn.inverse() * (in_image - mid_eyes) / kIpd;
    }
};

/// Pixel of the patch that shows a point given in IPD from the mid-eye point, x right, y down.
Eigen::Vector2d patch_pixel(const Eigen::Vector2d& in_ipd);

FacePatch make_patch(ColorView image, const Eigen::Vector2d& pupil_right, const Eigen::Vector2d& pupil_left);

/// A line in IPD, with unit normals.
struct Polyline {
    Points2 points;
    Points2 normals;
};

/// `count` points evenly along the smooth curve through `knots`; normals are the tangents turned by -90
/// degrees (a line that runs to the right has normals that point up in the image).
Polyline resample(const Points2& knots, int count);

/// Row i: channel from -half_width to +half_width (IPD) along the normal at point i.
cv::Mat1f sample_strip(const cv::Mat1f& channel, const Polyline& line, double half_width, int steps);

/// Column of the best path through a strip of scores, from the first row to the last, a column a row;
/// sub-pixel. bend: cost of one column of sideways step, squared.
std::vector<double> best_path(const cv::Mat1f& scores, double bend);

/// Value at a sub-pixel place, clamped at the border.
float sample(const cv::Mat1f& channel, double x, double y);

}  // namespace mimetic::locate
