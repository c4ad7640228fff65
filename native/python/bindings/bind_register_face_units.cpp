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
    m.def(
        "close_slit",
        [](const MuscleSurface& surface, PointsIn displacement, const SkinPlaces& upper,
           const SkinPlaces& lower, double upper_share, double reach, bool keeps_gap) {
            return close_slit(surface, displacement, upper, lower, {upper_share, reach, keeps_gap});
        },
        "surface"_a, "displacement"_a, "upper"_a, "lower"_a, "upper_share"_a, "reach"_a, "keeps_gap"_a,
        release_gil(),
        "A displacement (N, 3) of a skin, corrected so that the rims of a slit close, as far as at rest, or "
        "so\nthat they meet. upper, lower: SkinPlaces in pairs; reach: metres. Raises InvalidInput.");
    m.def("rim_gaps", &rim_gaps, "vertices"_a, "displacement"_a, "upper"_a, "lower"_a, release_gil(),
          "(K,) metres between the displaced rims.");
}

}  // namespace mimetic::bindings
