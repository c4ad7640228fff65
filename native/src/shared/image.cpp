// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic {

void check_image_size(int rows, int cols, const char* name) {
    if (std::min(rows, cols) < kSmallestImage || std::max(rows, cols) > kLargestImage) {
        throw InvalidInput(std::string(name) + " is " + std::to_string(cols) + " x " + std::to_string(rows) +
                           " pixels; each side must be " + std::to_string(kSmallestImage) + " to " +
                           std::to_string(kLargestImage) + ": scale the footage");
    }
}

}  // namespace mimetic
