// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/eyes.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic::locate {
namespace {

/// Where the cascade's box has the subject's right pupil, in box widths; the left one mirrors it.
const Eigen::Vector2d kPupil(0.305, 0.385);
constexpr double kSpread = 0.045;
constexpr double kIrisRadius = 0.036;  // 5.9 mm of a box that is 163 mm wide

double squared(double x) { return x * x; }

/// Log prior of a pair: place, level and spacing.
double log_prior(const Eigen::Vector2d& right, const Eigen::Vector2d& left) {
    const Eigen::Vector2d middle = (right + left) / 2;
    const Eigen::Vector2d across = left - right;
    return -0.5 * (squared((middle.x() - 0.5) / kSpread) + squared((middle.y() - kPupil.y()) / kSpread) +
                   squared((across.x() - (1 - 2 * kPupil.x())) / kSpread) + squared(across.y() / 0.07));
}

double hit_bonus(const Eigen::Vector2d& pupil, const std::vector<Eigen::Vector2d>& hits) {
    double best = 0;
    for (const auto& hit : hits)
        best = std::max(best, std::exp(-0.5 * (pupil - hit).squaredNorm() / squared(0.04)));
    return best;
}

}  // namespace

cv::Mat1f iris_scores(const cv::Mat1f& luminance, double radius) {
    cv::Mat1f smooth, dx, dy;
    cv::GaussianBlur(luminance, smooth, {}, std::max(0.6, 0.18 * radius));
    cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 0.125);

    cv::Mat1f magnitude;
    cv::magnitude(dx, dy, magnitude);
    const float threshold = static_cast<float>(0.6 * cv::mean(magnitude)[0]);
    cv::Mat1f votes(luminance.size(), 0);
    const int reach = static_cast<int>(std::ceil(1.5 * radius));
    // Every strong gradient votes for the centres that it points away from, near one radius behind it.
    for (int y = 0; y < votes.rows; ++y) {
        for (int x = 0; x < votes.cols; ++x) {
            const float strength = magnitude(y, x);
            if (strength <= threshold) continue;
            const float gx = dx(y, x) / strength;
            const float gy = dy(y, x) / strength;
            // The rim's sides count more: lids cover its top and bottom.
            const float weight = std::min(strength, 4 * threshold) * (0.3f + 0.7f * std::abs(gx));
            for (int v = std::max(0, y - reach); v <= std::min(votes.rows - 1, y + reach); ++v) {
                for (int u = std::max(0, x - reach); u <= std::min(votes.cols - 1, x + reach); ++u) {
                    const float rx = static_cast<float>(x - u);
                    const float ry = static_cast<float>(y - v);
                    const float distance = std::sqrt(rx * rx + ry * ry);
                    if (distance < 0.4f) continue;
                    const float cosine = (rx * gx + ry * gy) / distance;
                    if (cosine < 0.7f) continue;
                    const auto off = static_cast<float>((distance - radius) / (0.35 * radius));
                    votes(v, u) += weight * cosine * cosine * std::exp(-0.5f * off * off);
                }
            }
        }
    }
    double highest = 0;
    cv::minMaxLoc(votes, nullptr, &highest);
    if (highest <= 0) return votes;

    // Darkness of the disc against both its sides
    cv::Mat1f disc;
    cv::GaussianBlur(luminance, disc, {}, 0.6 * radius);
    const int side = std::max(1, static_cast<int>(std::lround(1.9 * radius)));
    cv::Mat1f scores(luminance.size(), 0);
    for (int y = 0; y < scores.rows; ++y) {
        for (int x = 0; x < scores.cols; ++x) {
            const float center = disc(y, x);
            const float left = disc(y, std::max(0, x - side));
            const float right = disc(y, std::min(scores.cols - 1, x + side));
            const float contrast =
                (0.5f * (left + right) - center) / (0.5f * (left + right) + center + 0.05f);
            scores(y, x) =
                0.55f * votes(y, x) / static_cast<float>(highest) + 1.5f * std::clamp(contrast, 0.0f, 0.3f);
        }
    }
    return scores;
}

std::vector<Iris> peaks(const cv::Mat1f& scores, double apart, std::size_t count) {
    std::vector<Iris> found;
    cv::Mat1f rest = scores.clone();
    while (found.size() < count) {
        double best = 0;
        cv::Point place;
        cv::minMaxLoc(rest, nullptr, &best, nullptr, &place);
        if (best <= 0) break;
        Iris iris{{place.x, place.y}, std::min(best, 1.0)};
        if (place.x > 0 && place.x + 1 < scores.cols && place.y > 0 && place.y + 1 < scores.rows) {
            const auto vertex = [](double a, double b, double c) {
                const double curvature = a - 2 * b + c;
                return curvature < -1e-9 ? std::clamp(0.5 * (a - c) / curvature, -0.5, 0.5) : 0.0;
            };
            iris.center.x() += vertex(scores(place.y, place.x - 1), best, scores(place.y, place.x + 1));
            iris.center.y() += vertex(scores(place.y - 1, place.x), best, scores(place.y + 1, place.x));
        }
        found.push_back(iris);
        cv::circle(rest, place, static_cast<int>(std::ceil(apart)), cv::Scalar(0), cv::FILLED);
    }
    return found;
}

EyePair find_eyes(const cv::Mat1f& face, const std::vector<Eigen::Vector2d>& eye_hits) {
    const double width = face.cols;
    const double radius = kIrisRadius * width;
    std::vector<Eigen::Vector2d> hits;
    hits.reserve(eye_hits.size());
    for (const auto& hit : eye_hits) hits.push_back(hit / width);
    const auto candidates = [&](double center_x) {
        const cv::Rect window(static_cast<int>((center_x - 0.13) * width), static_cast<int>(0.25 * width),
                              static_cast<int>(0.26 * width), static_cast<int>(0.27 * width));
        auto found = peaks(iris_scores(face(window), radius), 1.2 * radius, 6);
        for (auto& iris : found) iris.center = (iris.center + Eigen::Vector2d(window.x, window.y)) / width;
        return found;
    };
    const auto rights = candidates(kPupil.x());
    const auto lefts = candidates(1 - kPupil.x());
    EyePair best;
    double best_total = -1e30;
    for (const auto& right : rights) {
        for (const auto& left : lefts) {
            const double seen = right.score + left.score;
            const double bonus = hit_bonus(right.center, hits) + hit_bonus(left.center, hits);
            const double prior = log_prior(right.center, left.center);
            const double total = 3 * seen + 1.2 * bonus + 0.5 * prior;
            if (total > best_total) {
                best_total = total;
                best = {right, left,
                        std::clamp(0.25 * seen + 0.25 * bonus, 0.0, 1.0) * std::exp(0.1 * prior)};
            }
        }
    }
    best.right.center *= width;
    best.left.center *= width;
    return best;
}

}  // namespace mimetic::locate
