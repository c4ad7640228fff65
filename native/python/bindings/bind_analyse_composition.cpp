// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/analyse/composition.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_analyse_composition(py::module_& m) {
    py::class_<ExpressionPart>(m, "ExpressionPart", "An expression on a time line; see composition.hpp.")
        .def(py::init([](const MatrixRows& values, const MatrixRows& stds, double start, double length,
                         double strength, double dominance) {
                 return ExpressionPart{values, stds, start, length, strength, dominance};
             }),
             "values"_a, "stds"_a, "start"_a, "length"_a, "strength"_a = 1., "dominance"_a = 1.,
             "values, stds: (N, C); start, length: seconds.")
        .def_readonly("start", &ExpressionPart::start)
        .def_readonly("length", &ExpressionPart::length);
    py::class_<CompositionOptions>(m, "CompositionOptions", "See composition.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("fading", &CompositionOptions::fading)
        .def_readwrite("exponent", &CompositionOptions::exponent);
    m.def(
        "compose_expressions",
        [](const std::vector<ExpressionPart>& parts, const Eigen::VectorXd& seconds,
           const CompositionOptions& options) {
            Composition composed = compose_expressions(parts, seconds, options);
            return std::pair{std::move(composed.values), std::move(composed.stds)};
        },
        "parts"_a, "seconds"_a, "options"_a = CompositionOptions(), py::call_guard<py::gil_scoped_release>(),
        "Values and standard deviations (T, C each) of parts played together at so many seconds (T,). "
        "Raises\nInvalidInput.");
    m.def("from_rest", &from_rest, "values"_a,
          "A motion (N, C) less the straight line from its first row to its last.");
    m.def(
        "still_motion", &still_motion, "values"_a, "num_rows"_a, "rise"_a, "fall"_a,
        "A still (C,) as a motion (num_rows, C) that rises and falls in so many rows. Raises InvalidInput.");
}

}  // namespace mimetic::bindings
