// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/register/landmark_finder.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_register_landmarks(py::module_& m) {
    py::class_<PlacedLandmarks>(m, "PlacedLandmarks", "Landmarks that were placed on a mesh.")
        .def_readonly("places", &PlacedLandmarks::places, "(L, 3), on the mesh, in its frame")
        .def_readonly("sigma", &PlacedLandmarks::sigma, "(L,) standard deviations, interpupillary distances")
        .def_readonly("mesh_from_template", &PlacedLandmarks::mesh_from_template);
    py::class_<DeformableTemplate>(m, "DeformableTemplate",
                                   "A head that can be any person of an identity space, and about it.")
        .def(py::init<PointsIn, TrianglesIn, MatrixIn, VectorIn, const std::vector<bool>&>(),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), py::arg("modes").noconvert(),
             py::arg("sigma").noconvert(), "is_face"_a, py::call_guard<py::gil_scoped_release>(),
             "vertices: (V, 3), metres, head frame; triangles: (T, 3), of its skin; modes: (K, 3V), metres; "
             "sigma: (K,), their\nstandard deviations; is_face: (V,), the face without sockets and mouth. "
             "Raises InvalidInput.");
    py::class_<LandmarkFinder>(m, "LandmarkFinder",
                               "Places a template's landmarks on heads of any make, by pictures of both.")
        .def(py::init<PointsIn, TrianglesIn, std::vector<std::string>, std::vector<int>, DeformableTemplate,
                      const FeatureNetworks&>(),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "names"_a, "landmarks"_a,
             "people"_a, "networks"_a, py::keep_alive<1, 7>(), py::call_guard<py::gil_scoped_release>(),
             "The template: vertices (V, 3), metres, head frame; triangles (T, 3); landmarks: names and "
             "vertices;\npeople: who it can be. Raises InvalidInput.")
        .def(
            "place",
            [](const LandmarkFinder& finder, PointsIn vertices, TrianglesIn triangles,
               const std::optional<Progress>& progress) {
                const py::gil_scoped_release release;
                return finder.place(vertices, triangles, progress.value_or(Progress{}));
            },
            py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "progress"_a = py::none(),
            "PlacedLandmarks, or None where no face is seen or progress stopped the search.\n\n"
            "vertices: (V, 3), any unit and axes; triangles: (T, 3), outward. Raises InvalidInput.");
}

}  // namespace mimetic::bindings
