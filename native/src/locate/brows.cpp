// SPDX-License-Identifier: GPL-3.0-or-later
#include <opencv2/imgproc.hpp>

#include "locate/eyes.hpp"
#include "locate/measure.hpp"

namespace mimetic::locate {
namespace {

constexpr int kStations = 25;

void measure_brow(const FacePatch& patch, const Expected& expected, const std::string& side, Curves& curves) {
    constexpr int kSteps = 61;
    const double half_width = std::min(1.4 * expected.search, 0.24);
    Points2 knots(3, 2);
    // Both brows run from the image's left to its right, so that their normals point up
    const bool is_left = side == ".L";
    knots.row(0) = expected.at((is_left ? "brow_inner" : "brow_outer") + side);
    knots.row(1) = expected.at("brow_middle" + side);
    knots.row(2) = expected.at((is_left ? "brow_outer" : "brow_inner") + side);
    const Polyline search_line = resample(knots, kStations);
    const double step = 2 * half_width / (kSteps - 1);

    cv::Mat1f strip = sample_strip(patch.luminance, search_line, half_width, kSteps);
    // A brow is 0.1 to 0.18 IPD high: dark against a band above and a band below
    cv::Mat1f smooth;
    cv::GaussianBlur(strip, smooth, {}, 0.035 / step, 1.5);
    const int apart = static_cast<int>(std::lround(0.11 / step));
    cv::Mat1f response(strip.size());
    for (int i = 0; i < strip.rows; ++i) {
        for (int j = 0; j < strip.cols; ++j) {
            const float above = smooth(i, std::min(kSteps - 1, j + apart));
            const float below = smooth(i, std::max(0, j - apart));
            // Above is forehead; below may be the shadow of a deep socket, so it counts for less
            response(i, j) = 0.7f * (above - smooth(i, j)) + 0.3f * (below - smooth(i, j));
        }
    }
    cv::Scalar mean, spread;
    cv::meanStdDev(response, mean, spread);
    const double unit = std::max(spread[0], 1e-4);
    cv::Mat1f scores(response.size());
    for (int i = 0; i < scores.rows; ++i) {
        for (int j = 0; j < scores.cols; ++j) {
            const double off = (j * step - half_width) / (0.8 * expected.search);
            scores(i, j) = static_cast<float>(std::clamp(response(i, j) / unit, -1.5, 3.0) - 0.3 * off * off);
        }
    }
    const auto path = best_path(scores, 0.25);
    MeasuredCurve curve{search_line, {}};
    for (int i = 0; i < kStations; ++i) {
        const double j = path[static_cast<std::size_t>(i)];
        curve.line.points.row(i) += (j * step - half_width) * search_line.normals.row(i);
        const double here = std::clamp(sample(response, j, i) / unit / 2, 0.0, 1.0);
        // The place of the hair on the ridge differs between people by more than the error of measurement
        curve.sigma.push_back(0.065 + 0.08 * (1 - here));
    }
    curves["brow" + side] = curve;
}

}  // namespace

void measure_brows(const FacePatch& patch, const Expected& expected, Curves& curves) {
    for (const char* side : {".R", ".L"}) measure_brow(patch, expected, side, curves);
}

void measure_irises(const FacePatch& patch, const Expected& expected, Features& features) {
    constexpr double kRadius = 0.092;  // 5.8 mm of 63
    for (const char* name : {"pupil.R", "pupil.L"}) {
        const Eigen::Vector2d center = expected.at(name);
        const double reach = std::min(expected.search, 0.12) + 1.6 * kRadius;
        const Eigen::Vector2d corner = patch_pixel(center).array() - reach * kIpd;
        const int side = static_cast<int>(2 * reach * kIpd);
        const cv::Rect window =
            cv::Rect(static_cast<int>(corner.x()), static_cast<int>(corner.y()), side, side) &
            cv::Rect(0, 0, patch.luminance.cols, patch.luminance.rows);
        cv::Mat1f scores = iris_scores(patch.luminance(window), kRadius * kIpd);
        for (int y = 0; y < scores.rows; ++y) {
            for (int x = 0; x < scores.cols; ++x) {
                const Eigen::Vector2d place(x + window.x, y + window.y);
                const double off =
                    (place - patch_pixel(center)).norm() / kIpd / std::min(expected.search, 0.1);
                scores(y, x) *= static_cast<float>(std::exp(-0.5 * off * off));
            }
        }
        const auto found = peaks(scores, 1, 1);
        if (found.empty()) {
            features[name] = {center, 0.08, 0};
            continue;
        }
        const Eigen::Vector2d place =
            (found[0].center + Eigen::Vector2d(window.x, window.y) - patch_pixel({0, 0})) / kIpd;
        features[name] = {place, 0.02 + 0.04 * (1 - found[0].score), found[0].score};
    }
}

}  // namespace mimetic::locate
