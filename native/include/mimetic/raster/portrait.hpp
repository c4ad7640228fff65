// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// What a small picture of a head shows.
struct PortraitOptions {
    int size = 256;       ///< pixels of a side, 16 to 2048
    double middle_x = 0;  ///< metres, of the picture's middle in the head frame
    double middle_y = 0;  ///< metres
    double height = .24;  ///< metres that the picture shows, .01 to 10
    void check() const;   ///< throws InvalidInput: field, value, limit
};

/// A head from the front, lit, on transparent ground: size x size x 4, red, green, blue, opacity, the top row
/// first. vertices: V x 3, metres, head frame; faces: F x 4; colours: F x 3, 0 to 1, faces with a colour
/// below 0 are left out. Throws InvalidInput.
std::vector<std::uint8_t> draw_portrait(PointsIn vertices, QuadsIn faces, PointsIn colours,
                                        const PortraitOptions& options = {});

}  // namespace mimetic
