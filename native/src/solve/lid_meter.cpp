// SPDX-License-Identifier: GPL-3.0-or-later
#include "lid_meter.hpp"

#include <limits>

#include "shared/bilinear.hpp"

namespace mimetic {

namespace {

// Rows run from above the upper margin to below the lower one, in heights of the opening.
constexpr double kFirst = -.6;
constexpr double kLast = 1.4;
constexpr double kLidSeen = -.45;  // the lid's own texture reaches this far above its margin
constexpr double kLash = .12;      // its dark margin and shadow this far below

double row_of(double height, int num_rows) { return (height - kFirst) / (kLast - kFirst) * (num_rows - 1); }

}  // namespace

bool LidMeter::fetch(const cv::Mat1b& gray, const FloatPixels& pixels, Profile& profile) const {
    const auto at = [&](int vertex) -> Eigen::Vector2d {
        return pixels.row(vertex).transpose().cast<double>();
    };
    const Eigen::Vector2d inner = at(slit_.inner), outer = at(slit_.outer);
    const Eigen::Vector2d middle = .5 * (inner + outer);
    const Eigen::Vector2d rise = at(slit_.upper) - middle, fall = at(slit_.lower) - middle;
    const double opening = (fall - rise).norm();
    constexpr double kSmallestOpening = 2.5, kSmallestWidth = 10;  // pixels
    if (opening < kSmallestOpening || (outer - inner).norm() < kSmallestWidth) {
        return false;
    }
    for (int column = 0; column < kColumns; ++column) {
        const double s = .25 + .5 * column / (kColumns - 1);
        const Eigen::Vector2d base = inner + s * (outer - inner);
        const double arch = 4 * s * (1 - s);
        for (int row = 0; row < kRows; ++row) {
            const double height = kFirst + (kLast - kFirst) * row / (kRows - 1);
            const Eigen::Vector2d pixel = base + arch * ((1 - height) * rise + height * fall);
            if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < gray.cols - 1 &&
                  pixel.y() < gray.rows - 1)) {
                return false;
            }
            profile(row, column) = bilinear(gray, pixel.x(), pixel.y());
        }
    }
    return true;
}

void LidMeter::take_reference(const cv::Mat1b& gray, const FloatPixels& pixels) {
    usable_ = slit_.lid_upper >= 0 && fetch(gray, pixels, open_);
}

void LidMeter::slide(double closure, Profile& expected) const {
    for (int row = 0; row < kRows; ++row) {
        const double height = kFirst + (kLast - kFirst) * row / (kRows - 1);
        // Above: the lid, moved down whole and stretched out of its fold; below: the eye as it was.
        double from = height;
        if (height < closure + kLash) {
            from = std::max(height - closure, std::min(height, kLidSeen));
        } else if (closure < 0 && height < kLash) {
            from = kLash;
        }
        const double place = std::clamp(row_of(from, kRows), 0., kRows - 1.001);
        const int lower = static_cast<int>(place);
        expected.row(row) = (lower + 1 - place) * open_.row(lower) + (place - lower) * open_.row(lower + 1);
    }
}

LidMeasurement LidMeter::measure(const cv::Mat1b& gray, const FloatPixels& pixels) const {
    LidMeasurement measurement;
    Profile now;
    if (!usable_ || !fetch(gray, pixels, now)) {
        return measurement;
    }
    // Light: the skin above and below the opening, which the lid does not change, sets gain and offset.
    const double before = open_.mean(), after = now.mean();
    const double gain = std::clamp(std::sqrt((now.array() - after).square().mean() + 4) /
                                       std::sqrt((open_.array() - before).square().mean() + 4),
                                   .7, 1.4);
    constexpr int kSteps = 35;
    constexpr double kLowest = -.4, kHighest = 1.1;
    constexpr double kUnlike = 18;  // grey levels at which a difference stops counting more
    Eigen::Matrix<double, kSteps, 1> costs;
    Profile expected;
    for (int step = 0; step < kSteps; ++step) {
        slide(kLowest + (kHighest - kLowest) * step / (kSteps - 1), expected);
        const double scale = std::max(1., gain);
        const Profile residual = (now.array() - after) - scale * (expected.array() - expected.mean());
        // A lid at rest unless the picture says so: brows, gaze and squints change the eye's look as well.
        constexpr double kAtRest = .04;
        costs[step] = (residual.array().square() / (residual.array().square() + kUnlike * kUnlike)).mean() +
                      kAtRest * std::abs(kLowest + (kHighest - kLowest) * step / (kSteps - 1));
    }
    int best = 0;
    const double lowest = costs.minCoeff(&best);
    double shift = 0;
    if (best > 0 && best + 1 < kSteps) {
        const double bend = costs[best - 1] - 2 * lowest + costs[best + 1];
        shift = bend > 1e-9 ? std::clamp(.5 * (costs[best - 1] - costs[best + 1]) / bend, -.5, .5) : 0;
    }
    const double step_size = (kHighest - kLowest) / (kSteps - 1);
    measurement.closure = std::clamp(kLowest + step_size * (best + shift), kLowest, 1.);
    // Costs that are low over a wide range carry little information.
    const Eigen::ArrayXd likelihood = (-(costs.array() - lowest) / .02).exp();
    const Eigen::ArrayXd grid = Eigen::ArrayXd::LinSpaced(kSteps, kLowest, kHighest);
    const double spread = ((grid - measurement.closure).square() * likelihood).sum() / likelihood.sum();
    measurement.std = std::sqrt(spread + .05 * .05);
    measurement.seen = true;
    return measurement;
}

}  // namespace mimetic
