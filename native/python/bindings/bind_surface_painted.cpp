// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/surface/painted_surface.hpp>

#include "picture_arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

Paints paints_of(const std::vector<ImageArray>& pictures, const Eigen::VectorXi& picture_of_face,
                 const Points2& corners, const Eigen::VectorXd& brightness) {
    Paints paints{{}, picture_of_face, corners, brightness};
    for (const ImageArray& picture : pictures) {
        const ImageView<4> view = view_image<4>(picture, "a picture of a painted surface");
        paints.pictures.push_back({view.rows, view.cols, {view.data, view.data + picture.size()}});
    }
    return paints;
}

}  // namespace

void bind_surface_painted(py::module_& m) {
    py::class_<PaintedOptions>(m, "PaintedOptions", "See painted_surface.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("levels", &PaintedOptions::levels)
        .def_readwrite("finer", &PaintedOptions::finer)
        .def_readwrite("relief", &PaintedOptions::relief)
        .def_readwrite("ground", &PaintedOptions::ground);
    py::class_<PaintedSurface>(m, "PaintedSurface",
                               "The limit surface of a painted mesh as a camera sees it.")
        .def(
            py::init([](QuadsIn faces, const std::vector<ImageArray>& pictures,
                        const Eigen::VectorXi& picture_of_face, const Points2& corners,
                        const Eigen::VectorXd& brightness, const PaintedOptions& options) {
                return PaintedSurface(faces, paints_of(pictures, picture_of_face, corners, brightness),
                                      options);
            }),
            py::arg("faces").noconvert(), "pictures"_a, "picture_of_face"_a, "corners"_a, "brightness"_a,
            "options"_a = PaintedOptions(),
            "faces: (F, 4) int32; pictures: (H, W, 4) uint8 each; picture_of_face: (F,); corners: (4 F, 2), "
            "where\nfaces lie in them, 0 to 1 from the bottom left; brightness: (V,), 0 to 1, the light that "
            "reaches a\nplace. Raises InvalidInput.")
        .def(
            "draw",
            [](const PaintedSurface& self, const Camera& camera, PointsIn vertices,
               const Eigen::VectorXd& light) {
                ColorImage picture;
                {
                    const py::gil_scoped_release release;
                    picture = self.draw(camera, vertices, light);
                }
                return array_of(picture);
            },
            "camera"_a, py::arg("vertices_in_camera").noconvert(), "light"_a = Eigen::VectorXd(),
            "(H, W, 3) uint8 of vertices (V, 3) float64, metres, camera frame; light: of each picture, what "
            "its\ncolours are multiplied by, all 1 if it is empty. Raises InvalidInput.");
}

}  // namespace mimetic::bindings
