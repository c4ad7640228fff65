// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace mimetic {
namespace locate {
namespace {

/// Correlation of every patch of the image with one of the space's rows.
cv::Mat1f correlate(const cv::Mat1f& image, const Eigenspace& space, VectorIn row) {
    cv::Mat1f pattern(space.height, space.width);
    for (int i = 0; i < static_cast<int>(row.size()); ++i)
        pattern(i / space.width, i % space.width) = static_cast<float>(row(i));
    cv::Mat1f response;
    cv::matchTemplate(image, pattern, response, cv::TM_CCORR);
    return response;
}

/// Mean and deviation of every patch.
void moments(const cv::Mat1f& image, const Eigenspace& space, cv::Mat1d& mean, cv::Mat1d& deviation) {
    cv::Mat1d sum, squares;
    cv::integral(image, sum, squares, CV_64F, CV_64F);
    mean.create(image.rows - space.height + 1, image.cols - space.width + 1);
    deviation.create(mean.size());
    const double n = static_cast<double>(space.width) * space.height;
    const auto over = [&](const cv::Mat1d& table, int y, int x) {
        return table(y + space.height, x + space.width) - table(y, x + space.width) -
               table(y + space.height, x) + table(y, x);
    };
    for (int y = 0; y < mean.rows; ++y) {
        for (int x = 0; x < mean.cols; ++x) {
            mean(y, x) = over(sum, y, x) / n;
            const double variance = over(squares, y, x) / n - mean(y, x) * mean(y, x);
            deviation(y, x) = std::sqrt(std::max(0.0, variance));
        }
    }
}

double parabola_top(double before, double here, double after) {
    const double curvature = before - 2 * here + after;
    if (!std::isfinite(curvature) || curvature > -1e-9) return 0;
    return std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5);
}

}  // namespace

cv::Mat1f likelihoods(const Eigenspace& space, const cv::Mat1f& image, double least_deviation) {
    if (image.rows < space.height || image.cols < space.width) return {};
    // Single precision: what all patches share would drown what they differ in
    const cv::Mat1f centered = image - cv::mean(image)[0];
    cv::Mat1d mean, deviation;
    moments(centered, space, mean, deviation);

    // Of x = (patch - mean) / deviation less the space's mean: |x|^2 and its products with the basis
    const double n = static_cast<double>(space.mean.size());
    const cv::Mat1f with_mean = correlate(centered, space, space.mean);
    const double sum_of_mean = space.mean.sum();
    cv::Mat1d exponent(mean.size());
    for (int y = 0; y < mean.rows; ++y) {
        for (int x = 0; x < mean.cols; ++x) {
            const double product = (with_mean(y, x) - mean(y, x) * sum_of_mean) / deviation(y, x);
            exponent(y, x) = (n - 2 * product + space.mean.squaredNorm()) / space.rho;
        }
    }
    for (Eigen::Index i = 0; i < space.basis.rows(); ++i) {
        const Eigen::VectorXd mode = space.basis.row(i);
        const cv::Mat1f with_mode = correlate(centered, space, mode);
        const double sum = mode.sum();
        const double of_mean = mode.dot(space.mean);
        const double weight = 1 / space.eigenvalues(i) - 1 / space.rho;
        for (int y = 0; y < mean.rows; ++y) {
            for (int x = 0; x < mean.cols; ++x) {
                const double value = (with_mode(y, x) - mean(y, x) * sum) / deviation(y, x) - of_mean;
                exponent(y, x) += weight * value * value;
            }
        }
    }
    const double constant = log_normalizer(space);
    cv::Mat1f map(mean.size());
    for (int y = 0; y < map.rows; ++y) {
        for (int x = 0; x < map.cols; ++x) {
            map(y, x) = deviation(y, x) < least_deviation
                            ? -std::numeric_limits<float>::infinity()
                            : static_cast<float>(constant - 0.5 * exponent(y, x));
        }
    }
    return map;
}

std::vector<Eigen::Vector3d> summits(const cv::Mat1f& map, int count, double apart) {
    if (map.empty()) return {};
    cv::Mat1f highest;
    cv::dilate(map, highest, {});
    std::vector<Eigen::Vector3d> all;
    for (int y = 0; y < map.rows; ++y) {
        for (int x = 0; x < map.cols; ++x) {
            if (std::isfinite(map(y, x)) && map(y, x) >= highest(y, x)) all.emplace_back(x, y, map(y, x));
        }
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.z() > b.z(); });
    std::vector<Eigen::Vector3d> best;
    for (const auto& summit : all) {
        if (static_cast<int>(best.size()) == count) break;
        const auto is_near = [&](const auto& other) {
            return (other - summit).template head<2>().norm() < apart;
        };
        if (std::none_of(best.begin(), best.end(), is_near)) best.push_back(summit);
    }
    for (auto& summit : best) {
        const int x = static_cast<int>(summit.x());
        const int y = static_cast<int>(summit.y());
        if (x > 0 && x + 1 < map.cols) summit.x() += parabola_top(map(y, x - 1), map(y, x), map(y, x + 1));
        if (y > 0 && y + 1 < map.rows) summit.y() += parabola_top(map(y - 1, x), map(y, x), map(y + 1, x));
    }
    return best;
}

}  // namespace locate

MatrixRows likelihood_map(const Eigenspace& space, GrayView image) {
    space.check();
    check_image_size(image.rows, image.cols, "image");
    const cv::Mat bytes(image.rows, image.cols, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    cv::Mat1f values;
    bytes.convertTo(values, CV_32F);
    const cv::Mat1f map = locate::likelihoods(space, values, 1);
    MatrixRows out(map.rows, map.cols);
    for (int y = 0; y < map.rows; ++y) {
        for (int x = 0; x < map.cols; ++x) out(y, x) = map(y, x);
    }
    return out;
}

}  // namespace mimetic
