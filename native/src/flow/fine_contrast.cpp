// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/flow/fine_contrast.hpp>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/checks.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flow/methods.hpp"
#include "shared/as_matrix.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

constexpr int kBlock = 8;                                // pixels: as codecs have them
constexpr double kMiddleWidth = .6, kMiddleHeight = .7;  // of the face: hair and background have edges
constexpr float kLeastDeviation = 1;  // grey levels: rounding alone makes a flat block look fine

struct Extent {
    Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY);
    Eigen::Array2d high = Eigen::Array2d::Constant(-INFINITY);
};

Extent extent_of(const Camera& camera, PointsIn points) {
    Extent extent;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        require(points(i, 2) > 0,
                "point " + std::to_string(i) + " of the face is not in front of the camera");
        const Eigen::Array2d pixel = camera.project(points.row(i).transpose()).array();
        extent.low = extent.low.min(pixel);
        extent.high = extent.high.max(pixel);
    }
    return extent;
}

/// The middle of the face as far as the image shows it.
cv::Rect middle_of(const Extent& extent, const ColorView& image) {
    const Eigen::Array2d centre = (extent.low + extent.high) / 2;
    const Eigen::Array2d half = (extent.high - extent.low) / 2 * Eigen::Array2d(kMiddleWidth, kMiddleHeight);
    const Eigen::Array2d size(image.cols, image.rows);
    const Eigen::Array2i begin = (centre - half).max(0).min(size).cast<int>();
    const Eigen::Array2i end = (centre + half).max(0).min(size).cast<int>();
    return {begin.x(), begin.y(), end.x() - begin.x(), end.y() - begin.y()};
}

/// The grey levels there, a face larger than asked for scaled down.
cv::Mat1f gray_of(const ColorView& image, const cv::Rect& part, double scale) {
    cv::Mat color;
    as_matrix(image)(part).convertTo(color, CV_32F);
    cv::Mat1f gray;
    cv::cvtColor(color, gray, cv::COLOR_RGB2GRAY);
    if (scale < 1) {
        cv::resize(gray, gray, {}, scale, scale, cv::INTER_AREA);
    }
    return gray;
}

/// What `next` shows where the flow leads to from each pixel of `gray`.
cv::Mat1f brought_back(const cv::Mat1f& next, const cv::Mat1f& gray) {
    cv::Mat1b from;
    cv::Mat1b to;
    gray.convertTo(from, CV_8U);
    next.convertTo(to, CV_8U);
    FlowOptions options;  // the probabilistic method: DIS does no better here, and takes twice the time
    options.judges_noise = false;
    FlowField field = compute_flow({from.data, from.rows, from.cols, from.cols},
                                   {to.data, to.rows, to.cols, to.cols}, options);
    const cv::Mat targets = flow::targets_of(cv::Mat(field.rows, field.cols, CV_32FC2, field.flow.data()));
    cv::Mat1f back;  // shorter kernels leave little of the shortest waves
    cv::remap(next, back, targets, cv::noArray(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
    return back;
}

/// The amplitude of the shortest waves along both axes in the square of 2 x 2 pixels at (y, x).
float fine_at(const cv::Mat1f& gray, int y, int x) {
    return (gray(y, x) - gray(y, x + 1) - gray(y + 1, x) + gray(y + 1, x + 1)) / 2;
}

/// Of a block's variance, what both pictures have of the shortest waves: below 0 by chance, in noise.
float fine_share(const cv::Mat1f& block, const cv::Mat1f& again) {
    float product = 0;
    for (int y = 0; y < kBlock; y += 2) {
        for (int x = 0; x < kBlock; x += 2) {
            product += fine_at(block, y, x) * fine_at(again, y, x);
        }
    }
    cv::Scalar mean, deviation;
    cv::meanStdDev(block, mean, deviation);
    constexpr float kNumFine = kBlock * kBlock / 4;
    const float contrast = std::max(kLeastDeviation, static_cast<float>(deviation[0]));
    return product / kNumFine / (contrast * contrast);
}

}  // namespace

double fine_contrast(const ColorView& image, const ColorView& next, const Camera& camera,
                     PointsIn points_in_camera, int most_height) {
    camera.check();
    for (const ColorView& one : {image, next}) {
        require(one.cols == camera.width && one.rows == camera.height,
                "the image has not the size that the camera has");
    }
    require(points_in_camera.rows() > 0, "fine contrast of a face needs points of it");
    check_range("most_height", most_height, 1, 1 << 14);
    const Extent extent = extent_of(camera, points_in_camera);
    const cv::Rect middle = middle_of(extent, image);
    const double scale = std::min(1., most_height / (extent.high.y() - extent.low.y()));
    if (std::min(middle.width, middle.height) * scale < kSmallestImage) {
        return 0;
    }
    const cv::Mat1f gray = gray_of(image, middle, scale);
    const cv::Mat1f again = brought_back(gray_of(next, middle, scale), gray);
    std::vector<float> shares;
    for (int y = 0; y + kBlock <= gray.rows; y += kBlock) {
        for (int x = 0; x + kBlock <= gray.cols; x += kBlock) {
            const cv::Rect block(x, y, kBlock, kBlock);
            shares.push_back(fine_share(gray(block), again(block)));
        }
    }
    return std::sqrt(std::max(0.F, upper_median(shares)));
}

}  // namespace mimetic
