// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

namespace mimetic {

/// Ends of the middle 95 % of draws, and the one in the middle.
struct DrawnRange {
    double lower, median, upper;
};

/// Nothing of fewer than twenty draws: they say too little of their tails.
inline std::optional<DrawnRange> range_of(std::vector<double> draws) {
    if (draws.size() < 20) {
        return std::nullopt;
    }
    std::sort(draws.begin(), draws.end());
    const auto at = [&](double share) {
        return draws[static_cast<std::size_t>(share * static_cast<double>(draws.size() - 1))];
    };
    return DrawnRange{at(.025), at(.5), at(.975)};
}

}  // namespace mimetic
