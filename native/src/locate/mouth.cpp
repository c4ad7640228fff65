// SPDX-License-Identifier: GPL-3.0-or-later
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "locate/measure.hpp"

namespace mimetic::locate {
namespace {

constexpr int kStations = 61;
constexpr double kBeyond = 0.55;  // how far the search line runs past each corner, in half mouth widths

/// How dark and narrow a valley each pixel of the strip lies in (columns run across the lip line), in
/// luminance.
cv::Mat1f valley(const cv::Mat1f& strip, double sigma) {
    cv::Mat1f smooth, second;
    cv::GaussianBlur(strip, smooth, {}, sigma, 1.5);
    const cv::Mat1f kernel = (cv::Mat1f(1, 3) << 1, -2, 1);
    cv::filter2D(smooth, second, CV_32F, kernel);
    return second * (sigma * sigma);
}

Polyline lip_search_line(const Expected& expected) {
    const Eigen::Vector2d right = expected.at("mouth_corner.R");
    const Eigen::Vector2d left = expected.at("mouth_corner.L");
    const Eigen::Vector2d middle = expected.at("lip_line");
    Points2 knots(5, 2);
    // Past the corners the line runs level: cheeks, not smile lines
    knots.row(0) = right + kBeyond * 0.5 * (right - left);
    knots.row(1) = right;
    knots.row(2) = middle;
    knots.row(3) = left;
    knots.row(4) = left + kBeyond * 0.5 * (left - right);
    return resample(knots, kStations);
}

/// Mean over the stations [from, to) of a profile.
double mean_of(const std::vector<double>& values, int from, int to) {
    from = std::max(from, 0);
    to = std::min(to, static_cast<int>(values.size()));
    if (to <= from) return 0;
    return std::accumulate(values.begin() + from, values.begin() + to, 0.0) / (to - from);
}

/// Station where the lip line ends, walking from the middle in the direction `step`: the largest drop of
/// strength.
double line_end(const std::vector<double>& strength, int step, double expected_half, double sigma_half,
                double& contrast) {
    const int middle = kStations / 2;
    const double full = mean_of(strength, middle - 8, middle + 9);
    const int window = 4;
    double best = -1e30;
    int end = middle;
    for (int k = window; k + window < middle; ++k) {
        const int at = middle + step * k;
        const double inside =
            step > 0 ? mean_of(strength, at - window, at) : mean_of(strength, at + 1, at + window + 1);
        const double outside =
            step > 0 ? mean_of(strength, at + 1, at + window + 1) : mean_of(strength, at - window, at);
        const double off = (k - expected_half) / sigma_half;
        const double drop = std::min(inside - outside, full) / std::max(full, 1e-4);
        const double score = drop - 0.12 * off * off;
        if (score > best) {
            best = score;
            end = at;
            contrast = std::clamp(drop, 0.0, 1.0);
        }
    }
    return end;
}

Measured at_station(const Polyline& line, double station, double sigma, double likelihood) {
    const int i = std::clamp(static_cast<int>(station), 0, kStations - 2);
    const double t = station - i;
    return {(1 - t) * line.points.row(i) + t * line.points.row(i + 1), sigma, likelihood};
}

/// Outer borders of the red of the lips over the middle of the mouth.
void measure_vermilion(const FacePatch& patch, const Polyline& lip_line, const Expected& expected,
                       Features& features) {
    constexpr int kSteps = 61;
    constexpr double kHalf = 0.34;
    Polyline middle{lip_line.points.middleRows(kStations / 2 - 5, 11),
                    lip_line.normals.middleRows(kStations / 2 - 5, 11)};
    cv::Mat1f red, lum;
    cv::reduce(sample_strip(patch.redness, middle, kHalf, kSteps), red, 0, cv::REDUCE_AVG);
    cv::reduce(sample_strip(patch.luminance, middle, kHalf, kSteps), lum, 0, cv::REDUCE_AVG);
    cv::GaussianBlur(red, red, {}, 1.5, 0.1);
    cv::GaussianBlur(lum, lum, {}, 1.5, 0.1);
    cv::Scalar mean, red_spread, lum_spread;
    cv::meanStdDev(red, mean, red_spread);
    cv::meanStdDev(lum, mean, lum_spread);
    const Eigen::Vector2d center = lip_line.points.row(kStations / 2);
    const Eigen::Vector2d up = lip_line.normals.row(kStations / 2);
    const auto border = [&](const char* name, int direction, double lum_weight) {
        const double expected_offset = std::abs((expected.at(name) - expected.at("lip_line")).dot(up));
        double best = -1e30;
        double place = expected_offset;
        double edge = 0;
        for (int k = 2; k < kSteps / 2 - 1; ++k) {
            const int j = kSteps / 2 + direction * k;
            const double offset = kHalf * 2 * k / (kSteps - 1);
            // Outwards the red falls; above the upper lip the skin is lighter too
            const double fall =
                (red(0, j - direction) - red(0, j + direction)) / std::max(red_spread[0], 0.02);
            const double rise =
                (lum(0, j + direction) - lum(0, j - direction)) / std::max(lum_spread[0], 0.02);
            const double off = (offset - expected_offset) / 0.05;
            const double score = fall + lum_weight * rise - 0.25 * off * off;
            if (score > best) {
                best = score;
                place = offset;
                edge = fall + lum_weight * rise;
            }
        }
        const double likelihood = std::clamp(edge / 0.6, 0.0, 1.0);
        features[name] = {center + direction * place * up, 0.03 + 0.05 * (1 - likelihood), likelihood};
    };
    border("lip_upper", 1, 0.6);
    border("lip_lower", -1, 0.0);
}

}  // namespace

void measure_mouth(const FacePatch& patch, const Expected& expected, Features& features, Curves& curves) {
    constexpr int kSteps = 81;
    const double half_width = std::min(1.6 * expected.search, 0.34);
    const Polyline search_line = lip_search_line(expected);
    const cv::Mat1f lum = sample_strip(patch.luminance, search_line, half_width, kSteps);
    const double step = 2 * half_width / (kSteps - 1);  // IPD a column
    const cv::Mat1f narrow = valley(lum, 0.03 / step);
    const cv::Mat1f wide = valley(lum, 0.055 / step);
    cv::Mat1f red = sample_strip(patch.redness, search_line, half_width, kSteps);
    cv::GaussianBlur(red, red, {}, 0.07 / step, 2);
    const double usual_red = cv::mean(red)[0];

    cv::Mat1f response;
    cv::max(cv::InputArray(narrow), wide, response);
    cv::Scalar mean, spread;
    cv::meanStdDev(response, mean, spread);
    const double unit = std::max(spread[0], 1e-4);
    cv::Mat1f scores(response.size());
    for (int i = 0; i < scores.rows; ++i) {
        // The middle of the line decides: past the corners there may be nothing to follow
        const double from_middle = std::abs(2.0 * i / (kStations - 1) - 1) * (1 + kBeyond);
        const double weight = from_middle < 1 ? 1 : 0.35;
        for (int j = 0; j < scores.cols; ++j) {
            const double off = (j * step - half_width) / (0.8 * expected.search);
            scores(i, j) = static_cast<float>(
                weight * (std::clamp(response(i, j) / unit, -1.0, 4.0) + 4 * (red(i, j) - usual_red)) -
                0.35 * off * off);
        }
    }
    const auto path = best_path(scores, 0.12);

    std::vector<double> strength(kStations);
    Polyline line = search_line;
    for (int i = 0; i < kStations; ++i) {
        const double j = path[static_cast<std::size_t>(i)];
        strength[static_cast<std::size_t>(i)] = std::max(0.0f, sample(response, j, i));
        line.points.row(i) += (j * step - half_width) * search_line.normals.row(i);
    }
    line = resample(line.points, kStations);
    const double middle_strength = mean_of(strength, kStations / 2 - 8, kStations / 2 + 9);
    const double likelihood = std::clamp(middle_strength / unit / 2, 0.0, 1.0);

    const double half_stations = (kStations / 2) / (1 + kBeyond);
    double contrast_right = 0, contrast_left = 0;
    const double spread_stations = half_stations * std::min(0.3, 0.12 + expected.search);
    const double end_right = line_end(strength, -1, half_stations, spread_stations, contrast_right);
    const double end_left = line_end(strength, 1, half_stations, spread_stations, contrast_left);
    features["mouth_corner.R"] =
        at_station(line, end_right, 0.035 + 0.05 * (1 - contrast_right), contrast_right);
    features["mouth_corner.L"] =
        at_station(line, end_left, 0.035 + 0.05 * (1 - contrast_left), contrast_left);
    const double middle_x = expected.at("lip_line").x();
    double nearest = 1e30;
    int middle = kStations / 2;
    for (int i = 0; i < kStations; ++i) {
        if (std::abs(line.points(i, 0) - middle_x) < nearest) {
            nearest = std::abs(line.points(i, 0) - middle_x);
            middle = i;
        }
    }
    features["lip_line"] = at_station(line, middle, 0.025 + 0.05 * (1 - likelihood), likelihood);
    const int first = static_cast<int>(end_right), last = static_cast<int>(end_left);
    MeasuredCurve curve{
        {line.points.middleRows(first, last - first + 1), line.normals.middleRows(first, last - first + 1)},
        {}};
    curve.sigma.assign(static_cast<std::size_t>(last - first + 1), 0.03);
    curves["lip_line"] = curve;
    measure_vermilion(patch, line, expected, features);
}

}  // namespace mimetic::locate
