// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/flow/dissolve.hpp>
#include <mimetic/flow/fine_contrast.hpp>
#include <mimetic/flow/flow.hpp>
#include <optional>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using FloatArray = py::array_t<float, py::array::c_style>;

/// A numpy view that keeps the field alive.
py::array view_plane(const py::object& owner, const std::vector<float>& values, int channels) {
    const auto& field = owner.cast<const FlowField&>();
    return FloatArray({field.rows, field.cols, channels}, values.data(), owner);
}

FlowField compute(const ImageArray& from, const ImageArray& to, const FlowOptions& options,
                  const std::optional<FloatArray>& initial) {
    const GrayView from_view = view_image<1>(from, "the first image");
    const GrayView to_view = view_image<1>(to, "the second image");
    FlowField start;
    if (initial) {
        if (initial->ndim() != 3 || initial->shape(2) != 2) {
            throw InvalidInput("the initial flow must have the shape (height, width, 2) and be float32");
        }
        start = {static_cast<int>(initial->shape(0)),
                 static_cast<int>(initial->shape(1)),
                 std::vector<float>(initial->data(), initial->data() + initial->size()),
                 {}};
    }
    const py::gil_scoped_release release;
    return compute_flow(from_view, to_view, options, initial ? &start : nullptr);
}

}  // namespace

void bind_flow(py::module_& m) {
    py::enum_<FlowMethod>(m, "FlowMethod", "How flow is computed.")
        .value("probabilistic", FlowMethod::probabilistic, "Simoncelli, Adelson and Heeger 1991")
        .value("dis", FlowMethod::dis, "OpenCV's dense inverse search");
    py::class_<FlowOptions>(m, "FlowOptions", "Settings of compute_flow; see flow.hpp for units.")
        .def(py::init<>())
        .def_readwrite("method", &FlowOptions::method)
        .def_readwrite("num_levels", &FlowOptions::num_levels)
        .def_readwrite("finest_level", &FlowOptions::finest_level)
        .def_readwrite("iterations", &FlowOptions::iterations)
        .def_readwrite("gradient_noise", &FlowOptions::gradient_noise)
        .def_readwrite("temporal_noise", &FlowOptions::temporal_noise)
        .def_readwrite("prior_variance", &FlowOptions::prior_variance)
        .def_readwrite("process_variance", &FlowOptions::process_variance)
        .def_readwrite("judges_noise", &FlowOptions::judges_noise)
        .def_readwrite("first_guess", &FlowOptions::first_guess)
        .def("check", &FlowOptions::check, "Raises InvalidInput: field, value, limit.");
    py::class_<FlowField>(m, "FlowField", "Positions of one image's pixels in another.")
        .def_readonly("rows", &FlowField::rows)
        .def_readonly("cols", &FlowField::cols)
        .def_property_readonly(
            "flow",
            [](const py::object& self) { return view_plane(self, self.cast<const FlowField&>().flow, 2); },
            "(H, W, 2) float32, x right and y down, pixels")
        .def_property_readonly(
            "covariance",
            [](const py::object& self) {
                return view_plane(self, self.cast<const FlowField&>().covariance, 3);
            },
            "(H, W, 3) float32, xx, xy, yy, pixels^2");
    m.def("compute_flow", &compute, py::arg("from_image").noconvert(), py::arg("to_image").noconvert(),
          "options"_a = FlowOptions{}, py::arg("initial").noconvert() = py::none(),
          "Flow of every pixel of one image to another, with its 2x2 covariance.\n\n"
          "from_image, to_image: (H, W) uint8 of one size; initial: (H, W, 2) float32, pixels, or None\n"
          "returns: FlowField; raises InvalidInput on images that do not match");
    m.def(
        "fine_contrast",
        [](const ImageArray& image, const ImageArray& next, const Camera& camera, const Points& points,
           int most_height) {
            const ColorView view = view_image<3>(image, "the frame");
            const ColorView view_next = view_image<3>(next, "the next frame");
            const py::gil_scoped_release unlocked;
            return fine_contrast(view, view_next, camera, points, most_height);
        },
        py::arg("image").noconvert(), py::arg("next").noconvert(), "camera"_a, "points_in_camera"_a,
        "most_height"_a,
        "How much of a face's contrast is of the shortest waves, 2 pixels long along both axes, and stays\n"
        "on the face from a frame to the next.\n\n"
        "image, next: (H, W, 3) uint8; points_in_camera: K x 3, metres, of the face in the first;\n"
        "most_height: pixels, to which a larger face is scaled down first. Returns the median of its\n"
        "blocks of 8 x 8 pixels, a share of their standard deviation. Raises InvalidInput.");
    py::class_<DissolveWatch>(m, "DissolveWatch",
                              "Detects where one scene dissolves into another; see dissolve.hpp.")
        .def(py::init<>())
        .def_property_readonly_static(
            "longest", [](const py::object&) { return DissolveWatch::kLongest; },
            "frames: how far back from the last one added a dissolve may begin")
        .def(
            "add",
            [](DissolveWatch& watch, const ImageArray& image) -> std::optional<std::pair<int, int>> {
                const ColorView view = view_image<3>(image, "the frame");
                const py::gil_scoped_release unlocked;
                const auto mixed = watch.add(view);
                return mixed ? std::optional(std::pair(mixed->first, mixed->last)) : std::nullopt;
            },
            py::arg("image").noconvert(),
            "The next frame; returns which frames mix two scenes, or None.\n\n"
            "image: (H, W, 3) uint8, all of one size; returns: (first, last), frames back from this one.\n"
            "Raises InvalidInput.");
}

}  // namespace mimetic::bindings
