// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <limits>
#include <vector>

namespace mimetic {

constexpr double kTukeyCut = 4.7;  ///< standard deviations: 95 % efficient under Gaussian noise

/// Tukey's biweight of a residual, in cuts: 1 at 0, nothing from 1 on.
template <typename Scalar>
Scalar tukey_weight(Scalar cuts) {
    const Scalar kept = cuts < 1 ? 1 - cuts * cuts : 0;
    return kept * kept;
}

/// The middle value, of an even number the upper of both; `none` without values. Changes their order.
template <typename Scalar>
Scalar upper_median(std::vector<Scalar>& values, Scalar none = 0) {
    if (values.empty()) {
        return none;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The middle value, of an even number the mean of both; NaN without values.
inline double median(std::vector<double> values) {
    if (values.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// The value below which a share of the values lies, 0 to 1, linear between two of them; one value at least.
inline double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    const double at = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace mimetic
