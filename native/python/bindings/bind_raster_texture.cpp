// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/raster/texture.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

py::tuple texture_of(const Camera& camera, const ImageArray& image, PointsIn vertices, PointsIn normals,
                     const Quads& faces, const Points2& corners, int size,
                     const Eigen::VectorXd& vertex_weights) {
    const ColorView view = view_image<3>(image, "the frame");
    ProjectedTexture projected;
    {
        const py::gil_scoped_release release;
        projected = project_texture(camera, view, vertices, normals, {faces, corners, size}, vertex_weights);
    }
    ImageArray texture({size, size, 3});
    std::copy(projected.texture.pixels.begin(), projected.texture.pixels.end(), texture.mutable_data());
    return py::make_tuple(std::move(texture), projected.median_colour);
}

}  // namespace

void bind_raster_texture(py::module_& m) {
    m.def(
        "unwrap_values",
        [](const MatrixRows& values, const Quads& faces, const Points2& corners, int size) {
            const py::gil_scoped_release release;
            return unwrap_values({faces, corners, size}, values);
        },
        "values"_a, "faces"_a, "corners"_a, "size"_a,
        "(size * size, K) a picture of values (V, K) at vertices, first row on top; 0 where no face is.\n\n"
        "faces: (F, 4); corners: (4 F, 2), where they lie in the square, 0 to 1 from the bottom left\n"
        "raises InvalidInput");
    m.def("project_texture", &texture_of, "camera"_a, py::arg("image").noconvert(),
          py::arg("vertices_in_camera").noconvert(), "normals"_a, "faces"_a, "corners"_a, "size"_a,
          "vertex_weights"_a,
          "A texture (size, size, 3) uint8 with a frame's colours, and the skin's (3,), 0 to 255.\n\n"
          "image: (H, W, 3) uint8; vertices_in_camera: (V, 3) float64, metres; normals: (V, 3), unit;\n"
          "faces: (F, 4), all that may cover skin; corners: as for unwrap_values; size: a power of two;\n"
          "vertex_weights: (V,), 0 to 1. Raises InvalidInput, also if the face is outside the picture");
}

}  // namespace mimetic::bindings
