// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/contact/contact.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

void bind_contact(py::module_& m) {
    py::class_<ContactOptions>(m, "ContactOptions", "How contact is found and parted; SI units.")
        .def(py::init<>())
        .def_readwrite("deepest", &ContactOptions::deepest)
        .def_readwrite("tolerance", &ContactOptions::tolerance)
        .def_readwrite("softness", &ContactOptions::softness)
        .def_readwrite("relaxation", &ContactOptions::relaxation)
        .def_readwrite("convergence", &ContactOptions::convergence)
        .def_readwrite("max_sweeps", &ContactOptions::max_sweeps)
        .def_readwrite("max_rounds", &ContactOptions::max_rounds);

    py::class_<Slit>(m, "Slit", "Two rims across a slit that can touch, by numbers of points.")
        .def(py::init([](std::vector<int> upper, std::vector<int> lower, const Triangles& triangles) {
                 return Slit{std::move(upper), std::move(lower), triangles};
             }),
             "upper"_a, "lower"_a, "triangles"_a = Triangles(0, 3),
             "triangles: (T, 3) int32 of both surfaces; none if the rims are lines by x")
        .def_readonly("upper", &Slit::upper)
        .def_readonly("lower", &Slit::lower)
        .def_readonly("triangles", &Slit::triangles);

    py::class_<ContactSolver>(m, "ContactSolver",
                              "Contact without friction of points across slits, on an elastic skin.")
        .def(py::init<PointsIn, std::vector<Slit>, const Eigen::Ref<const ContactSolver::Response>&,
                      const ContactOptions&>(),
             py::arg("rest").noconvert(), "slits"_a, py::arg("response").noconvert(),
             "options"_a = ContactOptions{},
             "rest: (C, 3) float64, metres\n"
             "response: (C, 3C) float32, row j: how the points move, metres, xyz interleaved, under one\n"
             "    upward newton at point j")
        .def("solve", &ContactSolver::solve, py::arg("displacements").noconvert(), release_gil(),
             "Upward forces, (C,) newtons, that part what overlaps; all 0 if nothing does.\n\n"
             "displacements: (C, 3) float64, metres")
        .def("gaps", &ContactSolver::gaps, py::arg("displacements").noconvert(), release_gil(),
             "Gaps of what overlaps, metres, all negative.\n\ndisplacements: (C, 3) float64, metres");

    m.def("part_overlaps", &part_overlaps, "compliance"_a, "gaps"_a, "options"_a = ContactOptions{},
          release_gil(),
          "Forces f >= 0 with compliance @ f + gaps >= 0, at work only where that is 0.\n\n"
          "compliance: (K, K) m/N; gaps: (K,) metres\nreturns: (K,) newtons");
}

}  // namespace mimetic::bindings
