// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstring>
#include <mimetic/raster/overlay.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

/// (H, W, 3) uint8.
inline ImageArray array_of(const ColorImage& picture) {
    ImageArray array({picture.rows, picture.cols, 3});
    std::memcpy(array.mutable_data(), picture.pixels.data(), picture.pixels.size());
    return array;
}

}  // namespace mimetic::bindings
