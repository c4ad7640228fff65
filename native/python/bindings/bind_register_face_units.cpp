// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/register/face_units.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

void bind_register_face_units(py::module_& m) {
    m.def("surface_maps", &surface_maps, "source"_a, "target"_a, "triangles"_a, release_gil(),
          "(N, 9) linear maps that carry displacements of one surface (N, 3) to another of the same "
          "triangles\n(T, 3). Raises InvalidInput.");
    m.def("carried_by", &carried_by, "maps"_a, "displacement"_a, release_gil(),
          "(N, 3) displacements carried by surface_maps. Raises InvalidInput.");
    m.def(
        "rim_pairs",
        [](PointsIn upper, PointsIn lower, PointsIn corners, int count) {
            RimPairs pairs = rim_pairs(upper, lower, corners, count);
            return py::make_tuple(std::move(pairs.upper), std::move(pairs.lower));
        },
        "upper"_a, "lower"_a, "corners"_a, "count"_a,
        "Points of two rims, (count, 3) each, at the same shares of the way between the corners (2, 3).");
    py::class_<EyeSurface>(m, "EyeSurface", "A head's own eyeball, seen from its middle.")
        .def(py::init<>())
        .def(py::init<const Eigen::Vector3d&, PointsIn, TrianglesIn>(), "centre"_a, "vertices"_a,
             "triangles"_a, "vertices: (V, 3) metres; triangles: (T, 3), outward. Raises InvalidInput.")
        .def("depths", &EyeSurface::depths, "points"_a, release_gil(),
             "(K,) metres of points (K, 3) under its outermost shell, negative outside; -inf where it has "
             "none");
    py::class_<SlitPlaces>(m, "SlitPlaces", "Places on a skin in pairs, across a slit.")
        .def(py::init<SkinPlaces, SkinPlaces>(), "upper"_a, "lower"_a)
        .def_readonly("upper", &SlitPlaces::upper)
        .def_readonly("lower", &SlitPlaces::lower);
    m.def(
        "lid_rims", &lid_rims, "frame"_a, "vertices"_a, "triangles"_a, "top"_a, "bottom"_a, release_gil(),
        "The rims of an eye as a skin (N, 3) has them, near registered ones (K, 3): SlitPlaces without the\n"
        "pairs that the skin bridges. Raises InvalidInput.");
    m.def("are_joined", &are_joined, "surface"_a, "top"_a, "bottom"_a, release_gil(),
          "Whether skin covers a slit between rims (K, 3) in pairs.");
    m.def(
        "largest_depth", &largest_depth, "surface"_a, "displacement"_a, "rims"_a, "eye"_a, "reach"_a,
        release_gil(),
        "Metres that displaced skin (N, 3) within reach of the rims lies inside an eye at most, of vertices "
        "and\nmiddles of edges that are outside at rest.");
    m.def(
        "close_slit",
        [](const MuscleSurface& surface, PointsIn displacement, const SlitPlaces& slit, double upper_share,
           double reach, bool keeps_gap, const EyeSurface& eye) {
            return close_slit(surface, displacement, slit, {upper_share, reach, keeps_gap}, eye);
        },
        "surface"_a, "displacement"_a, "slit"_a, "upper_share"_a, "reach"_a, "keeps_gap"_a,
        "eye"_a = EyeSurface{}, release_gil(),
        "A displacement (N, 3) of a skin, corrected so that the rims of a slit close, as far as at rest, or "
        "so\nthat they meet, outside of an eye. reach: metres. Raises InvalidInput.");
    m.def("rim_gaps", &rim_gaps, "vertices"_a, "displacement"_a, "slit"_a, release_gil(),
          "(K,) metres between the displaced rims.");
}

}  // namespace mimetic::bindings
