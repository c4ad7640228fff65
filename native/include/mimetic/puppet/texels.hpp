// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic {

/// A picture as graphics cards take it: rows from the bottom up, of red, green, blue and opacity, 0 to 1.
struct Texels {
    int rows = 0;
    int cols = 0;
    std::vector<float> values;  ///< rows x cols x 4
};

/// A picture no wider than most_cols (16 to 4096), averaged where it is made smaller, opaque. Throws
/// InvalidInput.
Texels texels_of(const ColorView& image, int most_cols);

}  // namespace mimetic
