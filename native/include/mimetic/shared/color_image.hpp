// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic {

/// An image that owns its pixels: rows x cols x 3, red, green, blue.
struct ColorImage {
    int rows = 0;
    int cols = 0;
    std::vector<std::uint8_t> pixels;

    ColorView view() const { return {pixels.data(), rows, cols, 3 * std::ptrdiff_t{cols}}; }
};

}  // namespace mimetic
