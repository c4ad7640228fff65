// SPDX-License-Identifier: GPL-3.0-or-later
#include "crop_picture.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic::locate {
namespace {

constexpr int kMostHalves = 16;
constexpr double kLeastContrast = 0.02;  // as `scripts/build/eyes_and_lips/training.py` has it

/// Pixels of the picture from places in the crop, whose sides go from 0 to 1.
Eigen::Matrix<double, 2, 3> image_from_crop(const FeatureCrop& crop) {
    const double c = std::cos(crop.roll) * crop.side, s = std::sin(crop.roll) * crop.side;
    Eigen::Matrix<double, 2, 3> map;
    map << c, -s, crop.center.x() - 0.5 * (c - s),  //
        s, c, crop.center.y() - 0.5 * (s + c);
    return map;
}

/// The part of a picture that a crop shows, and what is about it; its corner at multiples of `grid`.
cv::Rect part_of(const cv::Size& picture, const FeatureCrop& crop, int grid) {
    const double reach = 0.75 * crop.side;
    const auto first = [&](double center) {
        return grid * static_cast<int>(std::floor((center - reach - 2) / grid));
    };
    const auto end = [&](double center) {
        return grid * static_cast<int>(std::ceil((center + reach + 3) / grid));
    };
    return cv::Rect(cv::Point(), picture) &
           cv::Rect(cv::Point(first(crop.center.x()), first(crop.center.y())),
                    cv::Point(end(crop.center.x()), end(crop.center.y())));
}

}  // namespace

cv::Mat blob_of(ColorView image, const FeatureCrop& crop, int side, bool mirrored) {
    cv::Mat picture = as_matrix(image);
    Eigen::Matrix<double, 2, 3> map = image_from_crop(crop);
    // Halves of the part that is seen, so that no detail is skipped over; from the same pixels of the picture
    // each time, so that what is seen does not flicker as the crop moves
    int num_halves = 0;
    for (double size = crop.side; size >= 2 * side && num_halves < kMostHalves; size /= 2) {
        ++num_halves;
    }
    const cv::Rect part = part_of(picture.size(), crop, 1 << num_halves);
    if (part.width < 2 || part.height < 2) {
        throw InvalidInput("the crop lies beside the picture; follow the face before asking for its points");
    }
    picture = picture(part);
    map.col(2) -= Eigen::Vector2d(part.x, part.y);
    for (; num_halves > 0 && std::min(picture.rows, picture.cols) >= 4; --num_halves) {
        cv::Mat half;
        cv::resize(picture, half, {}, 0.5, 0.5, cv::INTER_AREA);
        // By exactly a half, also where a side is odd: pixel i takes 2i and 2i + 1
        map *= 0.5;
        map.col(2).array() -= 0.25;
        picture = half;
    }
    const double step = 1.0 / side;
    cv::Matx23d warp(map(0, 0) * step, map(0, 1) * step, 0, map(1, 0) * step, map(1, 1) * step, 0);
    if (mirrored) {
        warp(0, 0) = -warp(0, 0);
        warp(1, 0) = -warp(1, 0);
    }
    const Eigen::Vector2d first =
        map * Eigen::Vector3d(mirrored ? 1 - 0.5 * step : 0.5 * step, 0.5 * step, 1);
    warp(0, 2) = first.x();
    warp(1, 2) = first.y();
    cv::Mat square;
    cv::warpAffine(picture, square, warp, {side, side}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return cv::dnn::blobFromImage(square, 1.0 / 255);
}

cv::Mat standardised(const cv::Mat& blob) {
    const cv::Mat values = blob.reshape(1, 1);
    cv::Scalar mean, deviation;
    cv::meanStdDev(values, mean, deviation);
    cv::Mat even;
    values.convertTo(even, CV_32F, 1 / (deviation[0] + kLeastContrast),
                     -mean[0] / (deviation[0] + kLeastContrast));
    const int shape[] = {1, blob.size[1], blob.size[2], blob.size[3]};
    return even.reshape(1, 4, shape);
}

Points2 in_picture(const Points2& shares, const FeatureCrop& crop, bool mirrored) {
    Eigen::Matrix<double, 2, 3> map = image_from_crop(crop);
    if (mirrored) {
        map.col(2) += map.col(0);
        map.col(0) = -map.col(0);
    }
    return (shares * map.leftCols<2>().transpose()).rowwise() + map.col(2).transpose();
}

Eigen::Vector2d in_crop(const Eigen::Vector2d& pixel, const FeatureCrop& crop) {
    const double c = std::cos(crop.roll) / crop.side, s = std::sin(crop.roll) / crop.side;
    const Eigen::Vector2d off = pixel - crop.center;
    return {.5 + c * off.x() + s * off.y(), .5 - s * off.x() + c * off.y()};
}

}  // namespace mimetic::locate
