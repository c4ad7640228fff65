// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/analyse/action_units.hpp>
#include <mimetic/analyse/comparison.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_action_units(py::module_& m) {
    py::class_<PointWarp>(m, "PointWarp", "A model's points laid on a head; see action_units.hpp.")
        .def(py::init<PointsIn, PointsIn>(), "from_points"_a, "to"_a,
             "The same points (A, 3) in the model and on the head. Raises InvalidInput.")
        .def("__call__", &PointWarp::operator(), "points"_a);
    m.def("displacement_about", &displacement_about, "vertices"_a, "is_skin"_a, "places"_a, "displacements"_a,
          "radius"_a, "A field (V, 3) that moves skin about places (K, 3), metres. Raises InvalidInput.");
    m.def("nearness_to", &nearness_to, "vertices"_a, "is_skin"_a, "places"_a, "radius"_a,
          "How near each vertex (V,) is to any of the places (K, 3), 0 to 1. Raises InvalidInput.");
    m.def("left_share", &left_share, "vertices"_a, "margin"_a,
          "How much each vertex (V,) belongs to the left side, 0 to 1; metres.");
}

}  // namespace

void bind_analyse_comparison(py::module_& m) {
    bind_action_units(m);
    m.def("skin_areas", &skin_areas, "vertices"_a, "faces"_a, "is_skin"_a,
          "Area of skin (V,), square metres, about each vertex.");
    m.def(
        "displacement_std",
        [](const ModesArray& modes, const Eigen::VectorXd& stds) {
            return displacement_std(view_modes("modes", modes, modes.ndim() == 3 ? modes.shape(1) : 0), stds);
        },
        "modes"_a, "stds"_a, "S.d. (V,) of displacements by modes (M, V, 3) with values' s.d. (M,).");
    py::class_<SpatialComparison>(m, "SpatialComparison", "See comparison.hpp.")
        .def_readonly("intensity", &SpatialComparison::intensity)
        .def_readonly("inside_explained", &SpatialComparison::inside_explained)
        .def_readonly("outside_share", &SpatialComparison::outside_share)
        .def_readonly("outside_significant_share", &SpatialComparison::outside_significant_share)
        .def_readonly("outside_far_share", &SpatialComparison::outside_far_share)
        .def_readonly("gini", &SpatialComparison::gini);
    m.def("compare_displacements", &compare_displacements, "vertices"_a, "seen"_a, "unit"_a, "areas"_a,
          "stds"_a, "reach"_a,
          "SpatialComparison of a displacement (V, 3) with an action unit's. Raises InvalidInput.");
    py::class_<TemporalComparison>(m, "TemporalComparison", "See comparison.hpp.")
        .def_readonly("rank_one_share", &TemporalComparison::rank_one_share)
        .def_readonly("ramp_explained", &TemporalComparison::ramp_explained)
        .def_readonly("ramp_whole_explained", &TemporalComparison::ramp_whole_explained)
        .def_readonly("course", &TemporalComparison::course)
        .def_readonly("ramp", &TemporalComparison::ramp);
    m.def(
        "compare_courses",
        [](const ModesArray& displacements, const Eigen::VectorXd& areas, int begin, int apex) {
            return compare_courses(view_modes("displacements", displacements, areas.size()), areas, begin,
                                   apex);
        },
        "displacements"_a, "areas"_a, "begin"_a, "apex"_a,
        "TemporalComparison of displacements (N, V, 3) with the application's rows. Raises InvalidInput.");
    py::class_<FacesInView>(m, "FacesInView", "See comparison.hpp.")
        .def_readonly("faces", &FacesInView::faces)
        .def_readonly("shades", &FacesInView::shades);
    m.def("faces_in_view", &faces_in_view, "vertices"_a, "faces"_a,
          "Faces visible along -z, back to front, with their shading.");
}

}  // namespace mimetic::bindings
