// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/flatten.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic::locate {
namespace {

constexpr double kMeanReach = 0.36;       // half width of the surroundings, pupil distances
constexpr double kDeviationReach = 0.45;  // the same
constexpr double kFloor = 5;              // grey levels: noise is not to look like contrast
constexpr double kIpdsPerWindow = 2;

int box_of(double reach, double ipd_px) { return 2 * static_cast<int>(std::lround(reach * ipd_px)) + 1; }

}  // namespace

cv::Mat1f float_image(GrayView image) {
    const cv::Mat bytes = as_matrix(image);
    cv::Mat1f values;
    bytes.convertTo(values, CV_32F);
    return values;
}

MatrixRows values_of(const cv::Mat1f& values) {
    MatrixRows out(values.rows, values.cols);
    for (int y = 0; y < values.rows; ++y) {
        for (int x = 0; x < values.cols; ++x) out(y, x) = values(y, x);
    }
    return out;
}

cv::Mat1f flatten(const cv::Mat1f& gray, double ipd_px) {
    const int mean_box = box_of(kMeanReach, ipd_px);
    const int deviation_box = box_of(kDeviationReach, ipd_px);
    cv::Mat1f mean, variance, deviation;
    cv::boxFilter(gray, mean, CV_32F, {mean_box, mean_box}, {-1, -1}, true, cv::BORDER_REFLECT_101);
    const cv::Mat1f off = gray - mean;
    cv::boxFilter(off.mul(off), variance, CV_32F, {deviation_box, deviation_box}, {-1, -1}, true,
                  cv::BORDER_REFLECT_101);
    // Running sums can end a little below 0
    cv::sqrt(cv::max(variance, 0.0), deviation);
    return off / (deviation + kFloor);
}

Pyramid::Pyramid(const cv::Mat1f& gray) {
    halves_.push_back(gray);
    while (std::min(halves_.back().rows, halves_.back().cols) >= 48) {
        cv::Mat1f half;
        cv::resize(halves_.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
        halves_.push_back(half);
    }
}

const cv::Mat1f& Pyramid::not_below(double scale) const {
    std::size_t half = 0;
    for (double finer = 0.5; half + 1 < halves_.size() && finer >= scale; finer /= 2) ++half;
    return halves_[half];
}

cv::Mat1f Pyramid::cut(const Eigen::Vector2d& center, double image_px_per_px, double roll,
                       cv::Size size) const {
    std::size_t half = 0;
    double factor = 1;
    while (half + 1 < halves_.size() && image_px_per_px / factor >= 1.6) {
        ++half;
        factor *= 2;
    }
    const double c = std::cos(roll) * image_px_per_px;
    const double s = std::sin(roll) * image_px_per_px;
    const double mid_x = 0.5 * (size.width - 1), mid_y = 0.5 * (size.height - 1);
    const double x = center.x() - c * mid_x + s * mid_y;
    const double y = center.y() - s * mid_x - c * mid_y;
    // Pixel centres: a pixel x of the whole image is (x + 0.5) / factor - 0.5 of the shrunken one
    const cv::Matx23d warp(c / factor, -s / factor, (x + 0.5) / factor - 0.5, s / factor, c / factor,
                           (y + 0.5) / factor - 0.5);
    cv::Mat1f window;
    cv::warpAffine(halves_[half], window, warp, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return window;
}

cv::Mat1f Pyramid::window(const Eigen::Vector2d& center, double image_px_per_px, double roll, cv::Size size,
                          double ipd_px) const {
    const int margin = box_of(kMeanReach, ipd_px);
    const cv::Size whole(size.width + 2 * margin, size.height + 2 * margin);
    return flatten(cut(center, image_px_per_px, roll, whole), ipd_px)(cv::Rect({margin, margin}, size));
}

std::vector<Level> levels(const Pyramid& pyramid, int side, double smallest, double largest,
                          int steps_per_octave) {
    const cv::Mat1f& image = pyramid.image();
    std::vector<double> widths;
    const double step = std::exp2(1.0 / steps_per_octave);
    for (double width = smallest; width <= largest; width *= step) widths.push_back(width);
    std::vector<Level> made(widths.size());
    cv::parallel_for_({0, static_cast<int>(widths.size())}, [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) {
            Level& level = made[static_cast<std::size_t>(i)];
            level.width = widths[static_cast<std::size_t>(i)];
            const double scale = side / level.width;
            const cv::Size size(static_cast<int>(std::lround(image.cols * scale)),
                                static_cast<int>(std::lround(image.rows * scale)));
            if (size.width < side || size.height < side) continue;
            cv::Mat1f small;
            const cv::Mat1f& source = pyramid.not_below(scale);
            cv::resize(source, small, size, 0, 0,
                       size.width < source.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
            level.flat = flatten(small, side / kIpdsPerWindow);
            level.px = {static_cast<double>(image.cols) / size.width,
                        static_cast<double>(image.rows) / size.height};
        }
    });
    std::erase_if(made, [](const Level& level) { return level.flat.empty(); });
    return made;
}

}  // namespace mimetic::locate
