// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic {

void check_image_size(int rows, int cols, const char* name) {
    constexpr int kSmallest = 16;
    constexpr int kLargest = 16384;
    if (rows < kSmallest || cols < kSmallest || rows > kLargest || cols > kLargest) {
        throw InvalidInput(std::string(name) + " is " + std::to_string(cols) + " x " + std::to_string(rows) +
                           " pixels; each side must be " + std::to_string(kSmallest) + " to " +
                           std::to_string(kLargest) + ": scale the footage");
    }
}

}  // namespace mimetic
