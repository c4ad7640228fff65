// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/surface/face_lines.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_surface_face_lines(py::module_& m) {
    py::class_<DrawnLines>(
        m, "DrawnLines",
        "What is seen of a face in one frame; places are parts of the picture, 0 to 1 from "
        "the bottom left, two rows a line.")
        .def_readonly("mesh", &DrawnLines::mesh, "(2K, 2) float32")
        .def_readonly("features", &DrawnLines::features, "(2K, 2) float32, of lids and lips")
        .def_readonly("rings", &DrawnLines::rings, "(2K, 2) float32")
        .def_readonly("marks", &DrawnLines::marks, "(P, 2) float32, seen or not")
        .def_readonly("marks_shown", &DrawnLines::marks_shown, "P booleans: in the picture, not covered");
    py::class_<FaceLines>(m, "FaceLines", "The limit surface of a face that moves by modes, as lines.")
        .def(py::init([](const Camera& camera, PointsIn neutral, const ModesArray& modes, QuadsIn faces,
                         std::vector<bool> is_shown, std::vector<std::vector<int>> features,
                         std::vector<int> marks) {
                 return FaceLines(camera, neutral, view_modes("modes", modes, neutral.rows()), faces,
                                  {std::move(is_shown), std::move(features), std::move(marks)});
             }),
             "camera"_a, py::arg("neutral").noconvert(), py::arg("modes").noconvert(),
             py::arg("faces").noconvert(), "is_shown"_a, "features"_a, "marks"_a,
             "neutral: (V, 3) metres, head frame; modes: (M, V, 3), metres at the value 1; faces: (F, 4) "
             "int32;\nis_shown: of each face, whether it is drawn and covers others; features: lines of "
             "vertices;\nmarks: vertices. Raises InvalidInput.")
        .def_property_readonly("num_values", &FaceLines::num_values)
        .def(
            "draw",
            [](const FaceLines& self, VectorIn values, const Eigen::Matrix4d& camera_from_head,
               const std::vector<Points>& rings) {
                const py::gil_scoped_release release;
                return self.draw(values, to_isometry(camera_from_head), rings);
            },
            "values"_a, "camera_from_head"_a, "rings"_a = std::vector<Points>{},
            "DrawnLines of a frame. values: (M,); camera_from_head: (4, 4); rings: closed lines, (K, 3) "
            "each,\nmetres, head frame, drawn where no skin covers them.");
}

}  // namespace mimetic::bindings
