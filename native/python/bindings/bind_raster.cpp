// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <mimetic/raster/overlay.hpp>
#include <mimetic/raster/rays.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

ImageArray paint(const OverlayPainter& painter, const ImageArray& image, PointsIn vertices, double quality,
                 int frame, const std::vector<Points>& rings) {
    const ColorView view = view_image<3>(image, "the picture");
    ColorImage painted;
    {
        const py::gil_scoped_release release;
        painted = painter.paint(view, vertices, quality, frame, rings);
    }
    ImageArray array({painted.rows, painted.cols, 3});
    std::memcpy(array.mutable_data(), painted.pixels.data(), painted.pixels.size());
    return array;
}

}  // namespace

void bind_raster(py::module_& m) {
    m.def(
        "cast_rays",
        [](const Camera& camera, PointsIn vertices, TrianglesIn triangles, Points2In pixels) {
            RayHits hits;
            {
                const py::gil_scoped_release release;
                hits = cast_rays(camera, vertices, triangles, pixels);
            }
            return py::make_tuple(hits.triangle, hits.weights);
        },
        "camera"_a, py::arg("vertices_in_camera").noconvert(), py::arg("triangles").noconvert(),
        py::arg("pixels").noconvert(),
        "The nearest triangle that faces the camera under each pixel: (K,) int32, -1 for none, and the "
        "place\nin "
        "it, (K, 3) weights of its corners.\n\nvertices_in_camera: (V, 3) float64, metres; triangles: (T, 3) "
        "int32;\npixels: (K, 2) float64. Raises InvalidInput.");
    py::class_<OverlayOptions>(m, "OverlayOptions", "How the overlay is drawn; see overlay.hpp for units.")
        .def(py::init<>())
        .def_readwrite("scale", &OverlayOptions::scale)
        .def_readwrite("opacity", &OverlayOptions::opacity)
        .def_readwrite("depth_tolerance", &OverlayOptions::depth_tolerance)
        .def_readwrite("held_quality", &OverlayOptions::held_quality);
    py::class_<OverlayPainter>(m, "OverlayPainter",
                               "Draws mesh, landmarks, quality and frame number over footage.")
        .def(py::init<const Camera&, int, QuadsIn, std::vector<int>, const OverlayOptions&>(), "camera"_a,
             "num_vertices"_a, py::arg("faces").noconvert(), "landmarks"_a, "options"_a = OverlayOptions{},
             "faces: (F, 4) int32; landmarks: vertices drawn as dots; raises InvalidInput")
        .def("paint", &paint, py::arg("image").noconvert(), py::arg("vertices_in_camera").noconvert(),
             "quality"_a, "frame"_a, "rings"_a = std::vector<Points>{},
             "image: (H, W, 3) uint8; vertices_in_camera: (V, 3) float64, metres; quality: 0 to 1; rings: of "
             "the\nirises, (K, 3) each, metres in the camera frame\n"
             "returns: (H * scale, W * scale, 3) uint8");
}

}  // namespace mimetic::bindings
