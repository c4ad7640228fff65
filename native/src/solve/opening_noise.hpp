// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

#include "opening_lines.hpp"

namespace mimetic {

/// Standard deviations of the measurement across an opening, in interpupillary distances, by how much of the
/// contour they move together: a contour of many points is few measurements.
struct OpeningNoise {
    double opening = 0;  ///< common to all lines
    double line = 0;     ///< common to each line
    double stretch = 0;  ///< smooth along a line
    double point = 0;    ///< independent for each point
    double pixels = 0;   ///< of each point, of the footage's grid
    double meeting = 0;  ///< correlation of line and stretch between lines that meet
    double width = 0;    ///< share of the distance between lines that meet: its own error
};

/// K squared, of an opening's places. pixel: one, in interpupillary distances; factor: of all deviations.
inline Eigen::MatrixXd covariance_of(const OpeningNoise& noise, const std::vector<LinePlace>& places,
                                     double pixel, double factor) {
    constexpr double kStretch = .2;  // of the line's length
    const auto square = [](double value) { return value * value; };
    const auto count = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd covariance(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            const LinePlace &a = places[static_cast<std::size_t>(i)],
                            &b = places[static_cast<std::size_t>(j)];
            double sum = square(noise.opening);
            const double alike = a.line == b.line ? 1 : a.meets && b.meets ? noise.meeting : 0;
            sum += alike * (square(noise.line) +
                            square(noise.stretch) * std::exp(-.5 * square((a.along - b.along) / kStretch)));
            if (i == j) {
                sum += square(noise.point) + square(noise.pixels * pixel);
            }
            covariance(i, j) = square(factor) * sum;
        }
    }
    return covariance;
}

}  // namespace mimetic
