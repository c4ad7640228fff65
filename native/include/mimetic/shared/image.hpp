// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>

namespace mimetic {

/// A non-owning view of an 8-bit image: rows x cols x Channels, rows `stride` bytes apart.
template <int Channels>
struct ImageView {
    const std::uint8_t* data = nullptr;
    int rows = 0;
    int cols = 0;
    std::ptrdiff_t stride = 0;

    const std::uint8_t* row(int y) const { return data + y * stride; }
};

using GrayView = ImageView<1>;
using ColorView = ImageView<3>;  ///< red, green, blue

inline constexpr int kSmallestImage = 16, kLargestImage = 16384;  ///< pixels, each side

/// Throws InvalidInput unless both sides lie within [kSmallestImage, kLargestImage].
void check_image_size(int rows, int cols, const char* name);

}  // namespace mimetic
