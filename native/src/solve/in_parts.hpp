// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <opencv2/core/utility.hpp>

namespace mimetic {

inline constexpr int kParts = 4;

/// Runs body(part, begin, end) over fixed parts of 0 .. count: sums must not depend on the scheduling of
/// threads.
template <typename Body>
void in_parts(std::size_t count, const Body& body) {
    cv::parallel_for_({0, kParts}, [&](const cv::Range& range) {
        for (int part = range.start; part < range.end; ++part) {
            const auto at = static_cast<std::size_t>(part);
            body(at, at * count / kParts, (at + 1) * count / kParts);
        }
    });
}

}  // namespace mimetic
