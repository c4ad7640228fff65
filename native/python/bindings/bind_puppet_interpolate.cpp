// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/puppet/interpolate.hpp>
#include <mimetic/puppet/low_lag_filter.hpp>
#include <mimetic/puppet/sharpening.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_puppet_interpolate(py::module_& m) {
    py::enum_<Basis>(m, "Basis", "What falls or rises with the distance of two vectors of scores.")
        .value("linear", Basis::linear)
        .value("gaussian", Basis::gaussian);
    py::class_<InterpolationOptions>(m, "InterpolationOptions", "How scores become a state.")
        .def(py::init<>())
        .def_readwrite("basis", &InterpolationOptions::basis)
        .def_readwrite("regularisation", &InterpolationOptions::regularisation,
                       "0: chosen by cross-validation");
    py::class_<Interpolation>(m, "Interpolation", "Scores to a state, by examples and radial bases.")
        .def(py::init<MatrixIn, MatrixIn, VectorIn, VectorIn, const InterpolationOptions&>(), "scores"_a,
             "states"_a, "lower"_a, "upper"_a, "options"_a = InterpolationOptions{},
             "scores: (K, n); states: (K, m), in order of time; lower, upper: (m,). Raises InvalidInput.")
        .def("state", &Interpolation::state, "scores"_a, "(m,) within the limits, of scores (n,).")
        .def("std", &Interpolation::std, "scores"_a,
             "(m,): what cross-validation misses by, more where the scores are far from every example.")
        .def_property_readonly("regularisation", &Interpolation::regularisation)
        .def_property_readonly("width", &Interpolation::width);
    m.def("hull_weights", &hull_weights, "corners"_a, "state"_a,
          "(J,) weights from 0 on, their sum 1, of the corners (J, m) for the nearest state in their hull.");
    py::class_<FilterOptions>(m, "FilterOptions", "How still and how quick a filter is.")
        .def(py::init<>())
        .def_readwrite("lag", &FilterOptions::lag, "s at rest, 0 to 1; 0: nothing is filtered")
        .def_readwrite("quickening", &FilterOptions::quickening, "Hz of cutoff a unit a second")
        .def_readwrite("speed_lag", &FilterOptions::speed_lag, "s, of the speed that decides");
    py::class_<LowLagFilter>(m, "LowLagFilter", "One Euro filter of several values.")
        .def(py::init<VectorIn, const FilterOptions&>(), "units"_a, "options"_a = FilterOptions{},
             "units: (n,), what 1 is of each value. Raises InvalidInput.")
        .def("advance", &LowLagFilter::advance, "values"_a, "seconds"_a,
             "(n,) filtered, of values `seconds` after those before.")
        .def_property_readonly("lags", &LowLagFilter::lags, "s, of each value in the last step")
        .def("restart", &LowLagFilter::restart, "The next values are taken as they are.");
    py::class_<Sharpening>(m, "Sharpening",
                           "Live values corrected by taught ones, each by its variance; see sharpening.hpp.")
        .def(py::init<Eigen::Index>(), "size"_a, "size: number of values. Raises InvalidInput.")
        .def(
            "advance",
            [](Sharpening& sharpening, VectorIn values, VectorIn std, VectorIn taught, VectorIn taught_std,
               double seconds) {
                const ValuesWithStd now = sharpening.advance({values, std}, {taught, taught_std}, seconds);
                return py::make_tuple(now.values, now.std);
            },
            "values"_a, "std"_a, "taught"_a, "taught_std"_a, "seconds"_a,
            "Values and standard deviations (n,), `seconds` after those before. Raises InvalidInput.")
        .def("restart", &Sharpening::restart, "Nothing is known of the live values any more.");
}

}  // namespace mimetic::bindings
