// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic {

void Camera::check() const {
    check_image_size(height, width, "camera image");
    for (const auto& [name, value] : {std::pair{"fx", fx}, std::pair{"fy", fy}}) {
        if (!std::isfinite(value) || value <= 0) {
            throw InvalidInput(std::string("camera ") + name + " is " + std::to_string(value) +
                               "; a focal length in pixels must be finite and above 0");
        }
    }
    if (!std::isfinite(cx) || !std::isfinite(cy)) {
        throw InvalidInput("camera cx, cy must be finite, in pixels");
    }
}

}  // namespace mimetic
