// SPDX-License-Identifier: GPL-3.0-or-later
#include <opencv2/imgproc.hpp>

#include "locate/measure.hpp"

namespace mimetic::locate {
namespace {

double squared(double x) { return x * x; }

struct Blob {
    Eigen::Vector2d place;  // IPD
    double strength;        // in standard deviations of the map
};

/// Dark spots of a nostril's size within a window round the expected nose base.
std::vector<Blob> dark_blobs(const FacePatch& patch, const Eigen::Vector2d& center, double reach_x,
                             double reach_y) {
    const Eigen::Vector2d corner = patch_pixel(center - Eigen::Vector2d(reach_x, reach_y));
    const cv::Rect window =
        cv::Rect(static_cast<int>(corner.x()), static_cast<int>(corner.y()),
                 static_cast<int>(2 * reach_x * kIpd), static_cast<int>(2 * reach_y * kIpd)) &
        cv::Rect(0, 0, patch.luminance.cols, patch.luminance.rows);
    std::vector<Blob> blobs;
    if (window.width < 5 || window.height < 5) return blobs;
    cv::Mat1f fine, coarse;
    cv::GaussianBlur(patch.luminance, fine, {}, 0.035 * kIpd);
    cv::GaussianBlur(patch.luminance, coarse, {}, 0.085 * kIpd);
    const cv::Mat1f dark = coarse(window) - fine(window);
    cv::Scalar mean, spread;
    cv::meanStdDev(dark, mean, spread);
    for (int y = 1; y + 1 < dark.rows; ++y) {
        for (int x = 1; x + 1 < dark.cols; ++x) {
            const float value = dark(y, x);
            if (value <= 0) continue;
            double highest = 0;
            cv::minMaxLoc(dark(cv::Rect(x - 1, y - 1, 3, 3)), nullptr, &highest);
            if (value < highest) continue;
            blobs.push_back(
                {Eigen::Vector2d(Eigen::Vector2d(x + window.x, y + window.y) - patch_pixel({0, 0})) / kIpd,
                 value / std::max(spread[0], 1e-4)});
        }
    }
    return blobs;
}

/// Side of the nose at the height of the nostrils: the strongest dark-going edge outwards.
void measure_ala(const FacePatch& patch, const Eigen::Vector2d& base, const Eigen::Vector2d& expected,
                 int side, const char* name, Features& features) {
    const double expected_offset = std::abs(expected.x() - base.x());
    double best = -1e30, place = expected_offset, edge = 0;
    for (double offset = 0.14; offset < 0.46; offset += 0.01) {
        double fall = 0;
        for (double dy = -0.16; dy <= 0.021; dy += 0.03) {
            const Eigen::Vector2d inner = patch_pixel(base + Eigen::Vector2d(side * (offset - 0.03), dy));
            const Eigen::Vector2d outer = patch_pixel(base + Eigen::Vector2d(side * (offset + 0.03), dy));
            const double difference =
                sample(patch.luminance, inner.x(), inner.y()) - sample(patch.luminance, outer.x(), outer.y());
            fall += difference / 7;
        }
        const double score = 12 * fall - 0.5 * squared((offset - expected_offset) / 0.045);
        if (score > best) {
            best = score;
            place = offset;
            edge = 12 * fall;
        }
    }
    const double likelihood = std::clamp(edge, 0.0, 1.0);
    features[name] = {
        {base.x() + side * place, base.y() + expected.y()}, 0.04 + 0.05 * (1 - likelihood), likelihood};
}

}  // namespace

void measure_nose(const FacePatch& patch, const Expected& expected, Features& features) {
    const Eigen::Vector2d right = expected.at("nostril.R");
    const Eigen::Vector2d left = expected.at("nostril.L");
    const Eigen::Vector2d middle = (right + left) / 2;
    const double width = left.x() - right.x();
    const double search = expected.search;
    const auto blobs = dark_blobs(patch, middle, width + search, 0.1 + search);
    double best = 1.5;  // what a pair must beat to count as seen
    const Blob* best_right = nullptr;
    const Blob* best_left = nullptr;
    for (const auto& a : blobs) {
        for (const auto& b : blobs) {
            const Eigen::Vector2d across = b.place - a.place;
            if (across.x() < 0.12 || across.x() > 0.45) continue;
            const Eigen::Vector2d center = (a.place + b.place) / 2;
            const double score = std::min(a.strength, 4.0) + std::min(b.strength, 4.0) -
                                 0.5 * (squared((across.x() - width) / 0.05) + squared(across.y() / 0.04) +
                                        squared((center.x() - middle.x()) / (0.5 * search)) +
                                        squared((center.y() - middle.y()) / (0.6 * search)));
            if (score > best) {
                best = score;
                best_right = &a;
                best_left = &b;
            }
        }
    }
    Eigen::Vector2d base = middle;
    double likelihood = 0;
    if (best_right != nullptr) {
        likelihood = std::clamp(best / 6, 0.0, 1.0);
        const double sigma = 0.03 + 0.07 * (1 - likelihood);
        features["nostril.R"] = {best_right->place, sigma, likelihood};
        features["nostril.L"] = {best_left->place, sigma, likelihood};
        base = (best_right->place + best_left->place) / 2;
    }
    for (const auto& [name, side] : {std::pair{"ala.R", -1}, std::pair{"ala.L", 1}}) {
        const Eigen::Vector2d offset = expected.at(name) - middle;
        measure_ala(patch, base, Eigen::Vector2d(base.x() + offset.x(), offset.y()), side, name, features);
    }
}

}  // namespace mimetic::locate
