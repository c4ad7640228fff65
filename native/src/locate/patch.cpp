// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/patch.hpp"

#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic::locate {
namespace {

constexpr int kWidth = 224;   // 3.5 IPD
constexpr int kHeight = 256;  // 4 IPD
const Eigen::Vector2d kMidEyes(112, 96);

/// Shrinks first where the face is larger than the patch: the warp alone would alias.
cv::Mat shrink(const cv::Mat& image, double scale, double& factor) {
    factor = 1;
    cv::Mat out = image;
    while (scale * factor < 0.6) {
        cv::Mat half;
        cv::resize(out, half, {}, 0.5, 0.5, cv::INTER_AREA);
        out = half;
        factor *= 2;
    }
    return out;
}

}  // namespace

Eigen::Vector2d patch_pixel(const Eigen::Vector2d& in_ipd) { return kMidEyes + kIpd * in_ipd; }

float sample(const cv::Mat1f& channel, double x, double y) {
    x = std::clamp(x, 0.0, channel.cols - 1.001);
    y = std::clamp(y, 0.0, channel.rows - 1.001);
    const int left = static_cast<int>(x);
    const int top = static_cast<int>(y);
    const auto fx = static_cast<float>(x - left);
    const auto fy = static_cast<float>(y - top);
    const float* upper = channel[top];
    const float* lower = channel[top + 1];
    return (1 - fy) * ((1 - fx) * upper[left] + fx * upper[left + 1]) +
           fy * ((1 - fx) * lower[left] + fx * lower[left + 1]);
}

FacePatch make_patch(ColorView image, const Eigen::Vector2d& pupil_right, const Eigen::Vector2d& pupil_left) {
    FacePatch patch;
    const Eigen::Vector2d across = (pupil_left - pupil_right) / kIpd;
    patch.turn << across.x(), -across.y(), across.y(), across.x();
    patch.mid_eyes = (pupil_left + pupil_right) / 2;

    const cv::Mat source = as_matrix(image);
    double factor = 1;
    const cv::Mat small = shrink(source, 1 / across.norm(), factor);
    // Pixel centres: a pixel x of the whole image is (x + 0.5) / factor - 0.5 of the shrunken one.
    const Eigen::Vector2d origin = (patch.mid_eyes - patch.turn * kMidEyes).array() + 0.5;
    cv::Matx23d warp(patch.turn(0, 0) / factor, patch.turn(0, 1) / factor, origin.x() / factor - 0.5,
                     patch.turn(1, 0) / factor, patch.turn(1, 1) / factor, origin.y() / factor - 0.5);
    cv::Mat rgb;
    cv::warpAffine(small, rgb, warp, {kWidth, kHeight}, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    patch.luminance.create(kHeight, kWidth);
    patch.redness.create(kHeight, kWidth);
    patch.blueness.create(kHeight, kWidth);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const cv::Vec3b& pixel = rgb.at<cv::Vec3b>(y, x);
            const float red = pixel[0] + 12.0f;  // damps noise in the ratio of dark pixels
            const float green = pixel[1] + 12.0f;
            const float blue = pixel[2] + 12.0f;
            patch.luminance(y, x) = (0.299f * pixel[0] + 0.587f * pixel[1] + 0.114f * pixel[2]) / 255;
            patch.redness(y, x) = std::log(red / green);
            patch.blueness(y, x) = std::log(blue / green);
        }
    }
    return patch;
}

Polyline resample(const Points2& knots, int count) {
    // Catmull-Rom through the knots, dense, then even in arc length
    constexpr int kDense = 16;
    const auto num_knots = static_cast<int>(knots.rows());
    std::vector<Eigen::Vector2d> dense;
    const auto knot = [&](int i) -> Eigen::Vector2d {
        if (i < 0) return 2 * knots.row(0) - knots.row(1);
        if (i >= num_knots) return 2 * knots.row(num_knots - 1) - knots.row(num_knots - 2);
        return knots.row(i);
    };
    for (int i = 0; i + 1 < num_knots; ++i) {
        for (int k = 0; k < kDense; ++k) {
            const double t = static_cast<double>(k) / kDense;
            const Eigen::Vector2d a = knot(i - 1), b = knot(i), c = knot(i + 1), d = knot(i + 2);
            dense.push_back(0.5 * (2 * b + t * (c - a) + t * t * (2 * a - 5 * b + 4 * c - d) +
                                   t * t * t * (3 * b - 3 * c + d - a)));
        }
    }
    dense.push_back(knot(num_knots - 1));
    std::vector<double> length(dense.size(), 0);
    for (std::size_t i = 1; i < dense.size(); ++i)
        length[i] = length[i - 1] + (dense[i] - dense[i - 1]).norm();

    Polyline line{Points2(count, 2), Points2(count, 2)};
    std::size_t at = 1;
    for (int i = 0; i < count; ++i) {
        const double target = length.back() * i / (count - 1);
        while (at + 1 < dense.size() && length[at] < target) ++at;
        const double span = std::max(length[at] - length[at - 1], 1e-12);
        const double t = std::clamp((target - length[at - 1]) / span, 0.0, 1.0);
        line.points.row(i) = (1 - t) * dense[at - 1] + t * dense[at];
    }
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector2d tangent =
            (line.points.row(std::min(i + 1, count - 1)) - line.points.row(std::max(i - 1, 0))).normalized();
        line.normals.row(i) = Eigen::Vector2d(tangent.y(), -tangent.x());
    }
    return line;
}

cv::Mat1f sample_strip(const cv::Mat1f& channel, const Polyline& line, double half_width, int steps) {
    cv::Mat1f strip(static_cast<int>(line.points.rows()), steps);
    for (int i = 0; i < strip.rows; ++i) {
        for (int j = 0; j < steps; ++j) {
            const double offset = half_width * (2.0 * j / (steps - 1) - 1);
            const Eigen::Vector2d point =
                patch_pixel(line.points.row(i).transpose() + offset * line.normals.row(i).transpose());
            strip(i, j) = sample(channel, point.x(), point.y());
        }
    }
    return strip;
}

std::vector<double> best_path(const cv::Mat1f& scores, double bend) {
    const int rows = scores.rows;
    const int cols = scores.cols;
    constexpr int kReach = 3;
    cv::Mat1f total = scores.clone();
    cv::Mat1i from(rows, cols, 0);
    for (int i = 1; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) {
            float best = -1e30f;
            for (int k = std::max(0, j - kReach); k <= std::min(cols - 1, j + kReach); ++k) {
                const float value = total(i - 1, k) - static_cast<float>(bend * (k - j) * (k - j));
                if (value > best) {
                    best = value;
                    from(i, j) = k;
                }
            }
            total(i, j) += best;
        }
    }
    std::vector<double> path(static_cast<std::size_t>(rows));
    int column = 0;
    for (int j = 1; j < cols; ++j) {
        if (total(rows - 1, j) > total(rows - 1, column)) column = j;
    }
    for (int i = rows - 1; i >= 0; --i) {
        double fraction = 0;
        if (column > 0 && column + 1 < cols) {
            const double left = scores(i, column - 1), mid = scores(i, column), right = scores(i, column + 1);
            const double curvature = left - 2 * mid + right;
            if (curvature < -1e-9) fraction = std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
        }
        path[static_cast<std::size_t>(i)] = column + fraction;
        if (i > 0) column = from(i, column);
    }
    return path;
}

}  // namespace mimetic::locate
