// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <mimetic/raster/portrait.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_raster_portrait(py::module_& m) {
    py::class_<PortraitOptions>(m, "PortraitOptions", "See portrait.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("size", &PortraitOptions::size)
        .def_readwrite("middle_x", &PortraitOptions::middle_x)
        .def_readwrite("middle_y", &PortraitOptions::middle_y)
        .def_readwrite("height", &PortraitOptions::height);
    m.def(
        "draw_portrait",
        [](PointsIn vertices, QuadsIn faces, PointsIn colours, const PortraitOptions& options) {
            std::vector<std::uint8_t> pixels;
            {
                const py::gil_scoped_release release;
                pixels = draw_portrait(vertices, faces, colours, options);
            }
            ImageArray array({options.size, options.size, 4});
            std::memcpy(array.mutable_data(), pixels.data(), pixels.size());
            return array;
        },
        "vertices"_a, "faces"_a, "colours"_a, "options"_a = PortraitOptions(),
        "A head from the front: (size, size, 4) uint8, red, green, blue, opacity.\n\nvertices: (V, 3), "
        "metres, head frame; faces: (F, 4) int32; colours: (F, 3), 0 to 1, below 0: left out.\nRaises "
        "InvalidInput.");
}

}  // namespace mimetic::bindings
