// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/locate/face_spaces.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_space(py::module_& m) {
    py::class_<Eigenspace>(
        m, "Eigenspace", "Gaussian density of image patches in their principal subspace and its complement.")
        .def(py::init([](int width, int height, const Eigen::VectorXd& mean, const MatrixRows& basis,
                         const Eigen::VectorXd& eigenvalues, double rho) {
                 Eigenspace space{width, height, mean, basis, eigenvalues, rho};
                 space.check();
                 return space;
             }),
             "width"_a, "height"_a, "mean"_a, "basis"_a, "eigenvalues"_a, "rho"_a,
             "width, height: of a patch, pixels; mean: N = width * height; basis: M x N, orthonormal rows;\n"
             "eigenvalues: M; rho: mean of those left out. Raises InvalidInput.")
        .def_readonly("width", &Eigenspace::width)
        .def_readonly("height", &Eigenspace::height)
        .def_readonly("mean", &Eigenspace::mean)
        .def_readonly("basis", &Eigenspace::basis)
        .def_readonly("eigenvalues", &Eigenspace::eigenvalues)
        .def_readonly("rho", &Eigenspace::rho);
    m.def("train_eigenspace", &train_eigenspace, py::arg("patches").noconvert(), "width"_a, "height"_a,
          "num_modes"_a, "shrinkage"_a = 0.01, py::call_guard<py::gil_scoped_release>(),
          "Principal components of patches (K x N, grey values, row by row).\n\n"
          "shrinkage: share of every eigenvalue that their mean replaces, 0 to 1");
}

void bind_face_spaces(py::module_& m) {
    py::class_<ViewSpace>(m, "ViewSpace", "The whole face under one yaw.")
        .def(py::init([](double yaw, const Eigen::VectorXd& filter, double threshold, Eigenspace space,
                         const Eigen::VectorXd& places, const MatrixRows& covariance) {
                 return ViewSpace{yaw, filter, threshold, std::move(space), places, covariance};
             }),
             "yaw"_a, "filter"_a, "threshold"_a, "space"_a, "places"_a, "covariance"_a,
             "yaw: degrees; filter: N; places: x0, y0, x1, ... of the modules from the middle, in window "
             "widths")
        .def_readonly("yaw", &ViewSpace::yaw)
        .def_readonly("filter", &ViewSpace::filter)
        .def_readonly("threshold", &ViewSpace::threshold)
        .def_readonly("space", &ViewSpace::space)
        .def_readonly("places", &ViewSpace::places)
        .def_readonly("covariance", &ViewSpace::covariance);
    py::class_<ModuleSpace>(m, "ModuleSpace", "A part of the face, and its surroundings.")
        .def(py::init([](std::string name, Eigenspace space, Eigenspace other, double width) {
                 return ModuleSpace{std::move(name), std::move(space), std::move(other), width};
             }),
             "name"_a, "space"_a, "other"_a, "width"_a, "width: of its window, in widths of the face's")
        .def_readonly("name", &ModuleSpace::name)
        .def_readonly("space", &ModuleSpace::space)
        .def_readonly("other", &ModuleSpace::other)
        .def_readonly("width", &ModuleSpace::width);
    py::class_<FaceSpaces>(m, "FaceSpaces",
                           "View-based and modular eigenspaces, and those of "
                           "false positives.")
        .def(py::init([](std::vector<ViewSpace> views, Eigenspace other, std::vector<ModuleSpace> modules,
                         const Eigen::VectorXd& weights) {
                 FaceSpaces spaces{std::move(views), std::move(other), std::move(modules), weights};
                 spaces.check();
                 return spaces;
             }),
             "views"_a, "other"_a, "modules"_a, "weights"_a,
             "weights: of the evidence, and a constant: log odds of a face. Raises InvalidInput.")
        .def_readonly("views", &FaceSpaces::views)
        .def_readonly("other", &FaceSpaces::other)
        .def_readonly("modules", &FaceSpaces::modules)
        .def_readonly("weights", &FaceSpaces::weights)
        .def("module", &FaceSpaces::module, "name"_a, "Index of a module; raises InvalidInput.");
}

}  // namespace

void bind_locate_eigenspace(py::module_& m) {
    bind_space(m);
    bind_face_spaces(m);
    const FaceSearch usual;
    py::class_<FaceSearch>(m, "FaceSearch", "Sizes and turns to search for faces.")
        .def(py::init([](double smallest, double largest, int steps_per_octave, double roll,
                         double least_probability) {
                 FaceSearch options{smallest, largest, steps_per_octave, roll, least_probability};
                 options.check();
                 return options;
             }),
             "smallest"_a = usual.smallest, "largest"_a = usual.largest,
             "steps_per_octave"_a = usual.steps_per_octave, "roll"_a = usual.roll,
             "least_probability"_a = usual.least_probability,
             "smallest: two pupil distances, pixels; largest: part of the shorter side; roll: radians");
    py::class_<FaceHint>(m, "FaceHint", "A square that another finder reports as a face.")
        .def(py::init<Eigen::Vector2d, double, double>(), "center"_a, "width"_a, "votes"_a,
             "center, width: of the face's window, pixels");
    py::class_<FoundFace>(m, "FoundFace", "A face: place, size, rotation, and the evidence for it.")
        .def_property_readonly("center", [](const FoundFace& f) { return f.center; })
        .def_readonly("width", &FoundFace::width, "of its window, pixels: two pupil distances")
        .def_readonly("roll", &FoundFace::roll, "radians, clockwise in the picture")
        .def_readonly("yaw", &FoundFace::yaw, "degrees, of the view that fits best")
        .def_readonly("probability", &FoundFace::probability)
        .def_readonly("places", &FoundFace::places, "pixels, a row a module")
        .def_readonly("evidence", &FoundFace::evidence);
    py::class_<FaceFinder>(m, "FaceFinder", "Maximum-likelihood search for faces.")
        .def(py::init<FaceSpaces>(), "spaces"_a)
        .def(
            "find",
            [](const FaceFinder& finder, const ImageArray& image, const FaceSearch& options,
               const std::vector<FaceHint>& hints) {
                const GrayView view = view_image<1>(image, "image");
                py::gil_scoped_release release;
                return finder.find(view, options, hints);
            },
            py::arg("image").noconvert(), "options"_a = usual, "hints"_a = std::vector<FaceHint>{},
            "Faces that do not overlap, the most probable first.\n\nimage: (H, W) uint8\n"
            "returns: list of FoundFace")
        .def(
            "find_near",
            [](const FaceFinder& finder, const ImageArray& image, const FoundFace& before,
               double least_probability) {
                const GrayView view = view_image<1>(image, "image");
                py::gil_scoped_release release;
                return finder.find_near(view, before, least_probability);
            },
            py::arg("image").noconvert(), "before"_a, "least_probability"_a = usual.least_probability,
            "The same face in another frame.");
    m.def(
        "flat_levels",
        [](const ImageArray& image, int side, const FaceSearch& options) {
            const GrayView view = view_image<1>(image, "image");
            py::gil_scoped_release release;
            std::vector<std::pair<MatrixRows, double>> made;
            for (auto& level : flat_levels(view, side, options))
                made.emplace_back(std::move(level.values), level.width);
            return made;
        },
        py::arg("image").noconvert(), "side"_a, "options"_a = usual,
        "Levels of an image, contrast flattened, as the search uses them: list of (values, window width)");
    m.def(
        "flat_window",
        [](const ImageArray& image, const Eigen::Vector2d& center, double width, double roll, int cols,
           int rows, double ipd_px) {
            const GrayView view = view_image<1>(image, "image");
            py::gil_scoped_release release;
            return flat_window(view, center, width, roll, cols, rows, ipd_px);
        },
        py::arg("image").noconvert(), "center"_a, "width"_a, "roll"_a, "cols"_a, "rows"_a, "ipd_px"_a,
        "A window of flattened contrast.\n\nwidth: of the window in the image, pixels; roll: radians;\n"
        "ipd_px: pupil distance in pixels of the window");
}

}  // namespace mimetic::bindings
