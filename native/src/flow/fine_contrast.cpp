// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/flow/fine_contrast.hpp>
#include <mimetic/shared/checks.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

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

float fine_share(const cv::Mat1f& block) {
    float square = 0;
    for (int y = 0; y < kBlock; y += 2) {
        for (int x = 0; x < kBlock; x += 2) {
            const float fine = (block(y, x) - block(y, x + 1) - block(y + 1, x) + block(y + 1, x + 1)) / 2;
            square += fine * fine;
        }
    }
    cv::Scalar mean, deviation;
    cv::meanStdDev(block, mean, deviation);
    constexpr float kNumFine = kBlock * kBlock / 4;
    return std::sqrt(square / kNumFine) / std::max(kLeastDeviation, static_cast<float>(deviation[0]));
}

}  // namespace

double fine_contrast(const ColorView& image, const Camera& camera, PointsIn points_in_camera,
                     int most_height) {
    camera.check();
    require(image.cols == camera.width && image.rows == camera.height,
            "the image has not the size that the camera has");
    require(points_in_camera.rows() > 0, "fine contrast of a face needs points of it");
    check_range("most_height", most_height, 1, 1 << 14);
    const Extent extent = extent_of(camera, points_in_camera);
    const cv::Rect middle = middle_of(extent, image);
    const double scale = std::min(1., most_height / (extent.high.y() - extent.low.y()));
    if (std::min(middle.width, middle.height) * scale < kBlock) {
        return 0;
    }
    const cv::Mat color = as_matrix(image);
    cv::Mat part;
    color(middle).convertTo(part, CV_32F);
    cv::Mat1f gray;
    cv::cvtColor(part, gray, cv::COLOR_RGB2GRAY);
    if (scale < 1) {
        cv::resize(gray, gray, {}, scale, scale, cv::INTER_AREA);
    }
    std::vector<float> shares;
    for (int y = 0; y + kBlock <= gray.rows; y += kBlock) {
        for (int x = 0; x + kBlock <= gray.cols; x += kBlock) {
            shares.push_back(fine_share(gray({x, y, kBlock, kBlock})));
        }
    }
    return upper_median(shares);
}

}  // namespace mimetic
