// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/eigenspace.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_space(py::module_& m) {
    py::class_<Eigenspace>(m, "Eigenspace",
                           "Gaussian density of image patches in their principal subspace and beside it.")
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
    py::class_<SpaceDistance>(m, "SpaceDistance", "Where a patch lies from an eigenspace.")
        .def_readonly("within", &SpaceDistance::within, "distance in feature space")
        .def_readonly("from_space", &SpaceDistance::from, "distance from feature space, squared")
        .def_readonly("log_likelihood", &SpaceDistance::log_likelihood);
    m.def("train_eigenspace", &train_eigenspace, py::arg("patches").noconvert(), "width"_a, "height"_a,
          "num_modes"_a, "shrinkage"_a = 0.01, py::call_guard<py::gil_scoped_release>(),
          "Principal components of patches (K x N, grey values, row by row).\n\n"
          "shrinkage: share of every eigenvalue that their mean replaces, 0 to 1");
    m.def("eigenspace_distance", &distance, "space"_a, "patch"_a, "patch: N grey values, row by row");
    m.def(
        "likelihood_map",
        [](const Eigenspace& space, const ImageArray& image) {
            const GrayView view = view_image<1>(image, "image");
            py::gil_scoped_release release;
            return likelihood_map(space, view);
        },
        "space"_a, py::arg("image").noconvert(),
        "Log likelihood of every patch of a (H, W) uint8 image, at its top left corner.");
}

}  // namespace

void bind_eigenspace(py::module_& m) {
    bind_space(m);
    const SpaceSearchOptions usual;
    py::class_<SpaceSearchOptions>(m, "SpaceSearchOptions", "Sizes and turns to search.")
        .def(py::init([](double smallest, double largest, int steps_per_octave, double largest_roll,
                         int num_rolls, int num_matches, double least_likelihood) {
                 SpaceSearchOptions options{smallest,  largest,     steps_per_octave, largest_roll,
                                            num_rolls, num_matches, least_likelihood};
                 options.check();
                 return options;
             }),
             "smallest"_a = usual.smallest, "largest"_a = usual.largest,
             "steps_per_octave"_a = usual.steps_per_octave, "largest_roll"_a = usual.largest_roll,
             "num_rolls"_a = usual.num_rolls, "num_matches"_a = usual.num_matches,
             "least_likelihood"_a = usual.least_likelihood,
             "smallest: patch width, pixels; largest: part of the shorter side; largest_roll: radians");
    py::class_<SpaceMatch>(m, "SpaceMatch", "A place, size and turn that looks like one of the spaces.")
        .def(py::init(
                 [](const Eigen::Vector2d& center, double width, double roll, int view,
                    double log_likelihood) { return SpaceMatch{center, width, roll, view, log_likelihood}; }),
             "center"_a, "width"_a, "roll"_a = 0.0, "view"_a = 0, "log_likelihood"_a = 0.0)
        .def_property_readonly("center", [](const SpaceMatch& s) { return s.center; })
        .def_readonly("width", &SpaceMatch::width, "of the patch, pixels")
        .def_readonly("roll", &SpaceMatch::roll, "radians, clockwise in the picture")
        .def_readonly("view", &SpaceMatch::view, "index of the space")
        .def_readonly("log_likelihood", &SpaceMatch::log_likelihood);
    m.def(
        "search_spaces",
        [](const std::vector<Eigenspace>& views, const ImageArray& image, const SpaceSearchOptions& options) {
            const GrayView view = view_image<1>(image, "image");
            py::gil_scoped_release release;
            return search_spaces(views, view, options);
        },
        "views"_a, py::arg("image").noconvert(), "options"_a = usual,
        "Maximum likelihood over position, scale, turn and view; the likeliest first.\n\n"
        "image: (H, W) uint8\nreturns: list of SpaceMatch");
    py::class_<FaceModule>(m, "FaceModule", "A part of the face with an eigenspace of its own.")
        .def(py::init<std::string, Eigenspace, double, Eigen::Vector2d>(), "name"_a, "space"_a, "width"_a,
             "place"_a, "width: of its patch; place: from the face's centre; both in the face's widths")
        .def_readonly("name", &FaceModule::name)
        .def_readonly("space", &FaceModule::space)
        .def_readonly("width", &FaceModule::width)
        .def_property_readonly("place", [](const FaceModule& f) { return f.place; });
    py::class_<ModulePlaces>(m, "ModulePlaces", "Where the parts of a face are.")
        .def_readonly("positions", &ModulePlaces::positions, "pixels, a row a module")
        .def_readonly("log_likelihood", &ModulePlaces::log_likelihood, "of each module by itself")
        .def_readonly("prior", &ModulePlaces::prior, "squared Mahalanobis distance from the mean places");
    m.def(
        "place_modules",
        [](const std::vector<FaceModule>& modules, const MatrixRows& covariance, const ImageArray& image,
           const SpaceMatch& face, int candidates) {
            const GrayView view = view_image<1>(image, "image");
            py::gil_scoped_release release;
            return place_modules(modules, covariance, view, face, candidates);
        },
        "modules"_a, "covariance"_a, py::arg("image").noconvert(), "face"_a, "candidates"_a = 4,
        "The modules' likeliest places together.\n\ncovariance: of all places, in squared widths of the "
        "face's patch\nimage: (H, W) uint8\nreturns: ModulePlaces");
}

}  // namespace mimetic::bindings
