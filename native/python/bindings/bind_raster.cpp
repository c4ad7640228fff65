// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/raster/gauge.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/raster/reframed.hpp>

#include "picture_arrays.hpp"

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
    return array_of(painted);
}

ImageArray reframed_picture(const ImageArray& image, const Camera& camera, const Camera& other) {
    const ColorView view = view_image<3>(image, "the picture");
    ColorImage picture;
    {
        const py::gil_scoped_release release;
        picture = reframed(view, camera, other);
    }
    return array_of(picture);
}

ImageArray with_gauge(const ImageArray& image, double quality, double held_quality, int frame) {
    const ColorView view = view_image<3>(image, "the picture");
    ColorImage picture{view.rows, view.cols, {view.data, view.data + image.size()}};
    draw_gauge(picture, quality, held_quality, frame);
    return array_of(picture);
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
    m.def(
        "reframed_camera",
        [](const Camera& camera, const Eigen::Vector2d& centre, double scale, int width, int height) {
            return reframed(camera, centre, scale, width, height);
        },
        "camera"_a, "centre"_a, "scale"_a, "width"_a, "height"_a,
        "A camera at the same place through another lens: the part of its picture about a pixel (2,), so "
        "many\ntimes as large. Raises InvalidInput.");
    m.def("reframed_picture", &reframed_picture, py::arg("image").noconvert(), "camera"_a, "other"_a,
          "A camera's picture (H, W, 3) uint8 through the lens of `reframed_camera`; black where it does not "
          "reach.\nRaises InvalidInput.");
    m.def("with_gauge", &with_gauge, py::arg("image").noconvert(), "quality"_a, "held_quality"_a, "frame"_a,
          "The picture (H, W, 3) uint8 with a frame's number and quality in a strip at its lower edge.");
}

}  // namespace mimetic::bindings
