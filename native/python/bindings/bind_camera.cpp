// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/camera.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_camera(py::module_& m) {
    py::class_<Camera>(m, "Camera", "Pinhole camera: x right, y down, z forward; pixels.")
        .def(py::init([](double fx, double fy, double cx, double cy, int width, int height) {
                 Camera camera{fx, fy, cx, cy, width, height};
                 camera.check();
                 return camera;
             }),
             "fx"_a, "fy"_a, "cx"_a, "cy"_a, "width"_a, "height"_a,
             "Focal lengths and principal point in pixels; raises InvalidInput.")
        .def_readonly("fx", &Camera::fx)
        .def_readonly("fy", &Camera::fy)
        .def_readonly("cx", &Camera::cx)
        .def_readonly("cy", &Camera::cy)
        .def_readonly("width", &Camera::width)
        .def_readonly("height", &Camera::height);
}

}  // namespace mimetic::bindings
