// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "image_level.hpp"

namespace mimetic::puppet {

/// A template at one size and rotation, ready to be multiplied with an image's rows.
struct Kernel {
    int rows = 0, cols = 0;
    int width = 0;                     ///< of a row, a multiple of 8, zeros behind `cols`
    std::vector<std::int16_t> values;  ///< rows x width, 0 to 255
    double sum = 0;
    double spread = 0;  ///< root of the sum of squared differences from the mean

    Kernel() = default;
    Kernel(const std::uint8_t* pixels, int num_rows, int num_cols);
};

/// Normalised correlation with the windows whose top-left pixels lie in `window`, a row a row of them.
/// The level's sums must cover those windows.
Eigen::MatrixXf correlate(const ImageLevel& level, const Kernel& kernel, const Window& window);

}  // namespace mimetic::puppet
