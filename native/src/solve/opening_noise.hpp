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
    double by_jaw = 0;   ///< share of what the jaw moves a line by, smooth along it: the model's error
};

inline constexpr double kStretch = .2;  ///< of a line's length: how far apart errors along it are alike

/// 0 to 1: how much alike what is smooth along lines is at two places.
inline double alike_along(const LinePlace& a, const LinePlace& b) {
    const double apart = (a.along - b.along) / kStretch;
    return std::exp(-.5 * apart * apart);
}

/// K squared, of an opening's places. pixel: one, in interpupillary distances; factor: of all deviations.
inline Eigen::MatrixXd covariance_of(const OpeningNoise& noise, const std::vector<LinePlace>& places,
                                     double pixel, double factor) {
    const auto square = [](double value) { return value * value; };
    const auto count = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd covariance(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            const LinePlace &a = places[static_cast<std::size_t>(i)],
                            &b = places[static_cast<std::size_t>(j)];
            double sum = square(noise.opening);
            const double alike = a.line == b.line ? 1 : a.meets && b.meets ? noise.meeting : 0;
            sum += alike * (square(noise.line) + square(noise.stretch) * alike_along(a, b));
            if (i == j) {
                sum += square(noise.point) + square(noise.pixels * pixel);
            }
            covariance(i, j) = square(factor) * sum;
        }
    }
    return covariance;
}

/// K squared: of how far a jaw moves the places across the lines (K), by a share of it. Both edges of a lip
/// err alike.
inline Eigen::MatrixXd jaw_covariance(double share, const std::vector<LinePlace>& places,
                                      const Eigen::VectorXd& moved) {
    const Eigen::Index count = moved.size();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            const LinePlace &a = places[static_cast<std::size_t>(i)],
                            &b = places[static_cast<std::size_t>(j)];
            if (a.line / 2 == b.line / 2) {  // two edges a lip
                covariance(i, j) = share * share * moved[i] * moved[j] * alike_along(a, b);
            }
        }
    }
    return covariance;
}

}  // namespace mimetic
