// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic::bindings {

using ImageArray = pybind11::array_t<std::uint8_t, pybind11::array::c_style>;

/// A view on a numpy image, (H, W) or (H, W, Channels) uint8, C order; the array must outlive the view.
template <int Channels>
ImageView<Channels> view_image(const ImageArray& image, const char* name) {
    const bool fits = Channels == 1 ? image.ndim() == 2 : image.ndim() == 3 && image.shape(2) == Channels;
    if (!fits) {
        throw InvalidInput(std::string(name) + " must have the shape (height, width" +
                           (Channels == 1 ? "" : ", " + std::to_string(Channels)) + ") and be uint8");
    }
    check_image_size(static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)), name);
    return {image.data(), static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)),
            static_cast<std::ptrdiff_t>(image.shape(1)) * Channels};
}

}  // namespace mimetic::bindings
