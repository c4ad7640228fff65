// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/raster/reframed.hpp>
#include <mimetic/shared/checks.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

/// Pixel centres are whole numbers: a picture of other size keeps the corner at (-.5, -.5) in place.
double resized(double pixel, double scale) { return (pixel + .5) * scale - .5; }

}  // namespace

Camera reframed(const Camera& camera, const Eigen::Vector2d& centre, double scale, int width, int height) {
    require(std::isfinite(scale) && scale > 0 && centre.allFinite(), "a part of a picture must be finite");
    const Camera other{camera.fx * scale,
                       camera.fy * scale,
                       (camera.cx - centre.x()) * scale + .5 * (width - 1),
                       (camera.cy - centre.y()) * scale + .5 * (height - 1),
                       width,
                       height};
    other.check();
    return other;
}

ColorImage reframed(const ColorView& image, const Camera& camera, const Camera& other) {
    camera.check();
    other.check();
    require(image.cols == camera.width && image.rows == camera.height,
            "the picture and the camera differ in size");
    cv::Mat source = as_matrix(image);
    const double scale_x = other.fx / camera.fx, scale_y = other.fy / camera.fy;
    // The filter of an affine warp looks at two pixels to a side: what is to be much smaller, is first halved
    const double shrink_x = std::min(1., 2 * scale_x), shrink_y = std::min(1., 2 * scale_y);
    cv::Mat shrunk = source;
    if (shrink_x < 1 || shrink_y < 1) {
        const auto side = [](int whole, double shrink) {
            return std::max(1, static_cast<int>(std::lround(whole * shrink)));
        };
        cv::resize(source, shrunk, {side(image.cols, shrink_x), side(image.rows, shrink_y)}, 0, 0,
                   cv::INTER_AREA);
    }
    const double real_x = static_cast<double>(shrunk.cols) / image.cols;
    const double real_y = static_cast<double>(shrunk.rows) / image.rows;
    const cv::Matx23d other_from_shrunk(
        scale_x / real_x, 0, other.cx - resized(camera.cx, real_x) * scale_x / real_x, 0, scale_y / real_y,
        other.cy - resized(camera.cy, real_y) * scale_y / real_y);
    ColorImage picture{other.height, other.width, {}};
    picture.pixels.resize(3 * static_cast<std::size_t>(other.height) * static_cast<std::size_t>(other.width));
    cv::Mat canvas(other.height, other.width, CV_8UC3, picture.pixels.data());
    cv::warpAffine(shrunk, canvas, other_from_shrunk, canvas.size(), cv::INTER_CUBIC, cv::BORDER_CONSTANT);
    return picture;
}

}  // namespace mimetic
