// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/analyse/confounding.hpp>
#include <mimetic/analyse/distinct_frames.hpp>
#include <mimetic/analyse/motion_scores.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using FlagArray = py::array_t<bool, py::array::c_style | py::array::forcecast>;

Eigen::Map<const MatrixRows> tracks_of(const DoubleArray& array, int dimensions) {
    if (array.ndim() != 3 || array.shape(2) != dimensions) {
        throw InvalidInput("tracks must have the shape (N, K, " + std::to_string(dimensions) + ")");
    }
    return {array.data(), array.shape(0), array.shape(1) * array.shape(2)};
}

Eigen::Map<const Rows<std::uint8_t, Eigen::Dynamic>> seen_of(const FlagArray& array) {
    if (array.ndim() != 2) {
        throw InvalidInput("what is seen must have the shape (N, K)");
    }
    return {reinterpret_cast<const std::uint8_t*>(array.data()), array.shape(0), array.shape(1)};
}

}  // namespace

void bind_analyse(py::module_& m) {
    m.def(
        "confounded_values", &confounded_values, "activations"_a, "activations_std"_a, "evidence"_a,
        py::call_guard<py::gil_scoped_release>(),
        "Muscles that the pictures cannot tell from another value: (N, P), its index, muscles first, or -1;\n"
        "see confounding.hpp. activations, activations_std: (N, P); evidence: (N, E) float32, as "
        "`pack_evidence` has it.\nRaises InvalidInput.");
    m.attr("MOVING_PX") = kMovingPx;
    m.attr("MOVING_M") = kMovingMetres;
    py::class_<ImageScores>(m, "ImageScores", "What predicted tracks are worth; see motion_scores.hpp.")
        .def_readonly("explained", &ImageScores::explained)
        .def_readonly("explained_beyond_head", &ImageScores::explained_beyond_head)
        .def_readonly("median_px", &ImageScores::median_px)
        .def_readonly("percentile_95_px", &ImageScores::percentile_95_px)
        .def_readonly("moving_median_px", &ImageScores::moving_median_px)
        .def_readonly("beyond_head_rms_px", &ImageScores::beyond_head_rms_px);
    m.def(
        "score_image_motion",
        [](const DoubleArray& tracks, const DoubleArray& rigid, const FlagArray& seen,
           const DoubleArray& predicted) {
            return score_image_motion(tracks_of(tracks, 2), tracks_of(rigid, 2), seen_of(seen),
                                      tracks_of(predicted, 2));
        },
        "tracks"_a, "rigid"_a, "seen"_a, "predicted"_a,
        "ImageScores of tracks (N, K, 2), pixels, against true ones; rigid: where the true head's motion "
        "alone\nwould take the points of the first frame. Raises InvalidInput.");
    py::class_<SurfaceScores>(m, "SurfaceScores", "What predicted points are worth; see motion_scores.hpp.")
        .def_readonly("explained", &SurfaceScores::explained)
        .def_readonly("median_mm", &SurfaceScores::median_mm)
        .def_readonly("moving_median_mm", &SurfaceScores::moving_median_mm)
        .def_readonly("shape_median_mm", &SurfaceScores::shape_median_mm);
    m.def(
        "score_surface_motion",
        [](const DoubleArray& points, const FlagArray& seen, const DoubleArray& predicted) {
            return score_surface_motion(tracks_of(points, 3), seen_of(seen), tracks_of(predicted, 3));
        },
        "points"_a, "seen"_a, "predicted"_a,
        "SurfaceScores of points (N, K, 3), metres, each in its own head frame. Raises InvalidInput.");
    m.def(
        "head_turn_errors",
        [](const DoubleArray& true_pose, const DoubleArray& pose) {
            return head_turn_errors(poses_of(true_pose, "poses"), poses_of(pose, "poses"));
        },
        "true_pose"_a, "pose"_a,
        "(N, 3) rotation vectors, degrees, camera axes, of the error in turning since the first frame.");
    m.def(
        "distinct_rows", &distinct_rows, "table"_a, "usable"_a, "first"_a, "count"_a,
        "Rows of a table (N, D) far from each other, rising, among the usable ones (N,) and the first one.");
}

}  // namespace mimetic::bindings
