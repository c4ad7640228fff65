// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/skin/strain.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

void bind_strain(py::module_& m) {
    py::class_<StrainMeter>(m, "StrainMeter", "How a skin is stretched from rest to another shape.")
        .def(py::init<PointsIn, TrianglesIn>(), py::arg("rest").noconvert(), py::arg("triangles").noconvert(),
             release_gil(),
             "rest: (N, 3) float64\ntriangles: (T, 3) int32\nraises InvalidInput, naming the triangle")
        .def_property_readonly("num_vertices", &StrainMeter::num_vertices)
        .def("at_vertices", &StrainMeter::at_vertices, py::arg("vertices").noconvert(), release_gil(),
             "Strain of a shape at its vertices; the same for any position and rotation of it.\n\n"
             "vertices: (N, 3) float64\n"
             "returns: (N, 3): area, largest and smallest length over rest, less 1; 0 where no triangle is");
}

}  // namespace mimetic::bindings
