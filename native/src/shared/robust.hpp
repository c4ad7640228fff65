// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
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

}  // namespace mimetic
