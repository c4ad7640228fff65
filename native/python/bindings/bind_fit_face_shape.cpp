// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/fit/face_shape.hpp>
#include <mimetic/fit/follow.hpp>
#include <mimetic/fit/picture.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

/// (N, V, 3) of rows of x, y and z of each vertex in turn.
py::array_t<double> to_modes(const MatrixRows& rows) {
    const Eigen::Index num_vertices = rows.cols() / 3;
    py::array_t<double> modes({rows.rows(), num_vertices, Eigen::Index{3}});
    std::copy(rows.data(), rows.data() + rows.size(), modes.mutable_data());
    return modes;
}

std::vector<bool> to_booleans(const py::array_t<bool, py::array::c_style>& values) {
    return std::vector<bool>(values.data(), values.data() + values.size());
}

void bind_shapes(py::module_& m) {
    m.def(
        "principal_shapes",
        [](const ModesArray& deformations, const std::vector<int>& seen, int most) {
            const auto rows = view_modes("deformations", deformations, deformations.shape(1));
            MatrixRows shares;
            MatrixRows components;
            {
                const py::gil_scoped_release release;
                shares = principal_shapes(rows, seen, most).shares;
                components = shares.transpose() * rows;
            }
            return py::make_tuple(shares, to_modes(components));
        },
        py::arg("deformations").noconvert(), "seen"_a, "most"_a,
        "(shares (N, K), components (K, V, 3)): the directions in which a sum of deformations (N, V, 3) "
        "varies "
        "most over\nthe vertices `seen`, largest first, at most `most`. Of each, the largest share is "
        "positive. "
        "Raises InvalidInput.");
    m.def(
        "paired_pulls",
        [](const Points& skin, const std::vector<int>& places,
           const py::array_t<bool, py::array::c_style>& on_face, double radius,
           int parity) { return to_modes(paired_pulls(skin, places, to_booleans(on_face), radius, parity)); },
        "skin"_a, "places"_a, "on_face"_a, "radius"_a, "parity"_a,
        "(N, S, 3) newtons on skin (S, 3) at places and opposite, spread by a Gaussian of radius metres over "
        "the "
        "face;\nparity: 1 as a mirror shows them, -1 opposed. Raises InvalidInput.");
    m.def("bumps", &bumps, "skin"_a, "places"_a, "radius"_a, release_gil(),
          "(K, S): heights at the skin's vertices (S, 3) of smooth bumps of s.d. `radius` metres round "
          "places;\nthe root of their squares' sum is 1 where it is largest. Raises InvalidInput.");
    m.def(
        "elastic_modes",
        [](const ModesArray& pulls, const ModesArray& responses, const std::vector<int>& face, double spread,
           double least_variance) {
            const auto forces = view_modes("pulls", pulls, pulls.shape(1));
            const auto moved = view_modes("responses", responses, pulls.shape(1));
            MatrixRows modes;
            {
                const py::gil_scoped_release release;
                modes = elastic_modes(forces, moved, face, spread, least_variance);
            }
            return to_modes(modes);
        },
        py::arg("pulls").noconvert(), py::arg("responses").noconvert(), "face"_a, "spread"_a,
        "least_variance"_a,
        "(K, S, 3) metres: principal components over the face of the prior exp(-energy) of an elastic skin, "
        "rms\n"
        "`spread` metres there, largest first, none with less than `least_variance` of the first's. pulls, "
        "responses:\n(N, S, 3), newtons and metres. Raises InvalidInput.");
    m.def(
        "sliding_on_eyeball",
        [](const ModesArray& modes, const Points& skin, const std::vector<int>& margin,
           const Eigen::Vector3d& centre, double reach, double steepest) {
            const auto rows = view_modes("modes", modes, skin.rows());
            MatrixRows sliding;
            {
                const py::gil_scoped_release release;
                sliding = sliding_on_eyeball(rows, skin, margin, centre, reach, steepest);
            }
            return to_modes(sliding);
        },
        py::arg("modes").noconvert(), "skin"_a, "margin"_a, "centre"_a, "reach"_a, "steepest"_a,
        "(N, S, 3): modes of a skin (S, 3) whose lid slides on its eyeball, as far as they go seen from the "
        "front,\nfading with the distance to the lid's margin (s.d. reach, metres). Raises InvalidInput.");
    m.def("nearest_coefficients", &nearest_coefficients, "matrix"_a, "values"_a, release_gil(),
          "(K,) nearest in least squares to values (N,) of matrix (N, K), the shortest of them.");
}

void bind_pictures(py::module_& m) {
    m.def(
        "facing_edges", &facing_edges, "vertices_in_camera"_a, "quads"_a, "facing"_a, release_gil(),
        "(E, 2) int32: edges of the quads (F, 4) that face the camera by more than the cosine `facing`, each "
        "once.\n\nvertices_in_camera: (V, 3), metres");
    py::class_<CanonicalPixels>(
        m, "CanonicalPixels", "What of the head each pixel of a canonical picture shows, of K that show any.")
        .def_readonly("pixel", &CanonicalPixels::pixel, "(K,) int32, row by row of the picture")
        .def_readonly("corners", &CanonicalPixels::corners, "(K, 4) int32 vertices")
        .def_readonly("weights", &CanonicalPixels::weights, "(K, 4), sum 1");
    m.def("canonical_pixels", &canonical_pixels, "vertices"_a, "quads"_a, "is_hidden"_a, "size"_a, "facing"_a,
          release_gil(),
          "The head from the front, orthographic, as large as fits a picture of size x size pixels.\n\n"
          "vertices: (V, 3), y up, z to the viewer; quads: (F, 4), left out where all corners are hidden "
          "(V,\nbool), or facing the viewer by less than the cosine `facing`. Raises InvalidInput.");
    m.def(
        "seen_colours",
        [](const ImageArray& image, const Camera& camera, const Points& vertices_in_camera,
           const CanonicalPixels& pixels, double facing) {
            const ColorView view = view_image<3>(image, "the picture");
            SeenColours seen;
            {
                const py::gil_scoped_release release;
                seen = seen_colours(view, camera, vertices_in_camera, pixels, facing);
            }
            py::array_t<bool> is_seen(static_cast<py::ssize_t>(seen.is_seen.size()));
            std::copy(seen.is_seen.begin(), seen.is_seen.end(), is_seen.mutable_data());
            return py::make_tuple(seen.colours, is_seen);
        },
        py::arg("image").noconvert(), "camera"_a, "vertices_in_camera"_a, "pixels"_a, "facing"_a,
        "(colours (K, 3) uint8, is_seen (K,) bool) of a picture at what CanonicalPixels show.\n\nfacing: "
        "cosine to the camera below which a surface shows nothing. Raises InvalidInput.");
    m.def(
        "mirror_correlation",
        [](const ImageArray& picture, const py::array_t<bool, py::array::c_style>& is_seen) {
            const ColorView view = view_image<3>(picture, "the canonical picture");
            const std::vector<bool> seen = to_booleans(is_seen);
            const py::gil_scoped_release release;
            return mirror_correlation(view, seen);
        },
        py::arg("picture").noconvert(), "is_seen"_a,
        "Correlation of a canonical picture (S, S, 3) with its mirror image, -1 to 1; is_seen: (S, S) bool.");
    m.def(
        "follow_points",
        [](const ImageArray& reference, const ImageArray& view, const Camera& camera,
           const Eigen::Matrix4d& reference_pose, const Eigen::Matrix4d& view_pose, std::vector<int> points,
           const Points& places, const Points& normals, double pupil_distance_px) {
            const ColorView before = view_image<3>(reference, "the reference"),
                            after = view_image<3>(view, "the view");
            std::vector<PointMotion> motion;
            {
                const py::gil_scoped_release release;
                motion =
                    follow_points(before, after, camera, to_isometry(reference_pose), to_isometry(view_pose),
                                  {std::move(points), places, normals}, pupil_distance_px);
            }
            MatrixRows rows(static_cast<Eigen::Index>(motion.size()), 4);
            for (Eigen::Index i = 0; i < rows.rows(); ++i) {
                const PointMotion& one = motion[static_cast<std::size_t>(i)];
                rows.row(i) << one.point, one.shift.x(), one.shift.y(), one.sigma_px;
            }
            return rows;
        },
        py::arg("reference").noconvert(), py::arg("view").noconvert(), "camera"_a, "reference_pose"_a,
        "view_pose"_a, "points"_a, "places"_a, "normals"_a, "pupil_distance_px"_a,
        "(K, 4): point, how far it moved right and down from the reference's picture to the view's, "
        "standard\n"
        "deviation, pixels. points: of the model, with places and normals (N, 3) in the head frame; poses: "
        "(4, 4) "
        "camera\nfrom head; pupil_distance_px: in the view. Points that fail the forward-backward check are "
        "left "
        "out.");
}

}  // namespace

void bind_fit_face_shape(py::module_& m) {
    bind_shapes(m);
    bind_pictures(m);
}

}  // namespace mimetic::bindings
