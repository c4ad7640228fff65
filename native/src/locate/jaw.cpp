// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "locate/measure.hpp"

namespace mimetic::locate {
namespace {

constexpr int kStations = 49;
constexpr int kSteps = 61;

/// Colour of this person's skin in this light: Gaussian of (luminance, redness, blueness).
struct SkinColor {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d precision = Eigen::Matrix3d::Identity();

    double likeness(const Eigen::Vector3d& color) const {
        const Eigen::Vector3d off = color - mean;
        return std::exp(-0.5 * off.dot(precision * off) / 4);
    }
};

SkinColor learn_skin(const FacePatch& patch, const Expected& expected) {
    const Eigen::Vector2d nose = (expected.at("nostril.R") + expected.at("nostril.L")) / 2;
    const double middle_y = 0.5 * nose.y();
    std::vector<Eigen::Vector3d> colors;
    for (const int side : {-1, 1}) {
        const Eigen::Vector2d cheek(nose.x() + 0.52 * side, nose.y() - 0.02);
        for (double dy = -0.16; dy <= 0.16; dy += 0.03) {
            for (double dx = -0.16; dx <= 0.16; dx += 0.03) {
                const auto p = patch_pixel(cheek + Eigen::Vector2d(dx, dy));
                colors.emplace_back(sample(patch.luminance, p.x(), p.y()),
                                    sample(patch.redness, p.x(), p.y()),
                                    sample(patch.blueness, p.x(), p.y()));
            }
        }
    }
    for (double dy = -0.15; dy <= 0.15; dy += 0.03) {
        const auto p = patch_pixel({0.5 * nose.x(), middle_y + dy});
        colors.emplace_back(sample(patch.luminance, p.x(), p.y()), sample(patch.redness, p.x(), p.y()),
                            sample(patch.blueness, p.x(), p.y()));
    }
    SkinColor skin;
    for (const auto& color : colors) skin.mean += color / static_cast<double>(colors.size());
    // Shading varies over a face more than over its cheeks
    Eigen::Matrix3d covariance = Eigen::Vector3d(0.004, 0.0015, 0.0015).asDiagonal();
    for (const auto& color : colors) {
        covariance +=
            (color - skin.mean) * (color - skin.mean).transpose() / static_cast<double>(colors.size());
    }
    skin.precision = covariance.inverse();
    return skin;
}

/// Mean of the columns [j - reach, j) and [j, j + reach) of a strip's row by running sums.
struct Sides {
    cv::Mat1d sums;
    explicit Sides(const cv::Mat1f& strip) : sums(strip.rows, strip.cols + 1, 0.0) {
        for (int i = 0; i < strip.rows; ++i) {
            for (int j = 0; j < strip.cols; ++j) sums(i, j + 1) = sums(i, j) + strip(i, j);
        }
    }
    double mean(int i, int from, int to) const {
        from = std::max(from, 0);
        to = std::min(to, sums.cols - 1);
        return to > from ? (sums(i, to) - sums(i, from)) / (to - from) : 0;
    }
};

}  // namespace

void measure_jaw(const FacePatch& patch, const Expected& expected, Curves& curves) {
    const double half_width = std::min(1.8 * expected.search, 0.36);
    const double step = 2 * half_width / (kSteps - 1);
    const Polyline line = resample(expected.curves.at("jaw"), kStations);
    const SkinColor skin = learn_skin(patch, expected);
    const Sides lum(sample_strip(patch.luminance, line, half_width, kSteps));
    const Sides red(sample_strip(patch.redness, line, half_width, kSteps));
    const Sides blue(sample_strip(patch.blueness, line, half_width, kSteps));
    const int reach = std::max(2, static_cast<int>(std::lround(0.07 / step)));

    cv::Mat1f response(kStations, kSteps, 0.0f), scores(kStations, kSteps, 0.0f);
    for (int i = 0; i < kStations; ++i) {
        const double under_chin = std::clamp(2.5 * line.normals(i, 1) - 1, 0.0, 1.0);
        for (int j = 2; j + 2 < kSteps; ++j) {
            const Eigen::Vector3d inside(lum.mean(i, j - reach, j), red.mean(i, j - reach, j),
                                         blue.mean(i, j - reach, j));
            const Eigen::Vector3d outside(lum.mean(i, j + 1, j + 1 + reach),
                                          red.mean(i, j + 1, j + 1 + reach),
                                          blue.mean(i, j + 1, j + 1 + reach));
            const Eigen::Vector3d change =
                (outside - inside).array() / Eigen::Vector3d(0.10, 0.10, 0.10).array();
            // Under the chin light ends: there an edge into brighter skin is a fold, not the outline
            const double brighter = under_chin * std::max(0.0, change(0));
            const double edge = std::min(change.norm(), 2.5) - 2 * brighter;
            const double leaves_skin = skin.likeness(inside) - skin.likeness(outside);
            response(i, j) =
                static_cast<float>(edge * (0.35 + 0.65 * skin.likeness(inside)) + 1.2 * leaves_skin);
            const double off = (j * step - half_width) / (0.9 * expected.search);
            scores(i, j) = static_cast<float>(response(i, j) - 0.35 * off * off);
        }
    }
    const auto path = best_path(scores, 0.3);
    MeasuredCurve curve{line, {}};
    for (int i = 0; i < kStations; ++i) {
        const double j = path[static_cast<std::size_t>(i)];
        curve.line.points.row(i) += (j * step - half_width) * line.normals.row(i);
        const double seen = std::clamp(sample(response, j, i) / 2.0, 0.0, 1.0);
        curve.sigma.push_back(0.04 + 0.12 * (1 - seen));
    }
    curves["jaw"] = curve;
}

}  // namespace mimetic::locate
