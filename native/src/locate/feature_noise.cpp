// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/locate/feature_noise.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

struct Measured {
    double jitter_along, jitter_across, error_along, error_across;  // % of the crop's side
    double enough;  // pixels of the crop's side; below it both grow with the square of what is missing
};

// In the order of NetworkFeature; `mimetic evaluate real` prints them beside what it measures
constexpr std::array<Measured, 7> kMeasured{{
    {0.08, 0.10, 0.81, 0.81, 14},    // upper lid
    {0.08, 0.08, 0.90, 0.90, 14},    // lower lid
    {0.025, 0.025, 0.43, 0.29, 40},  // corner of the eye
    {0.09, 0.08, 0.63, 0.66, 14},    // iris
    {0.04, 0.03, 0.80, 0.33, 45},    // corner of the mouth
    {0.045, 0.045, 0.42, 0.42, 40},  // outer lip
    {0.035, 0.035, 0.33, 0.33, 45},  // inner lip
}};

}  // namespace

FeatureNoise feature_noise(NetworkFeature feature, double side) {
    if (!(side > 0))
        throw InvalidInput("side of a crop is " + std::to_string(side) + "; it must be positive");
    const Measured& measured = kMeasured[static_cast<std::size_t>(feature)];
    const double lack = std::max(1.0, measured.enough / side);
    const double share = 0.01 * lack * lack;
    return {share * Eigen::Vector2d(measured.jitter_along, measured.jitter_across),
            share * Eigen::Vector2d(measured.error_along, measured.error_across)};
}

}  // namespace mimetic
