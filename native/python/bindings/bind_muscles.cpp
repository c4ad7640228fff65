// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/fibres.hpp>
#include <mimetic/muscles/muscles.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

void bind_muscles(py::module_& m) {
    py::enum_<MuscleType>(m, "MuscleType")
        .value("linear", MuscleType::linear)
        .value("sheet", MuscleType::sheet)
        .value("sphincter", MuscleType::sphincter);

    py::class_<Muscle>(m, "Muscle", "A muscle placed on a surface; metres, head frame.")
        .def(py::init([](MuscleType type, PointsIn insertion, const Eigen::Vector3d& origin, double width,
                         double normal_share, double protrusion, double swelling) {
                 Muscle muscle{type, insertion, origin, width, normal_share, protrusion, swelling};
                 muscle.check();
                 return muscle;
             }),
             py::kw_only(), "type"_a, "insertion"_a, "origin"_a, "width"_a, "normal_share"_a, "protrusion"_a,
             "swelling"_a,
             "insertion: (1, 3) linear; (2 or more, 3) sheet, its edge; (2, 3) sphincter, the foci, own side "
             "first\n"
             "origin: (3,) on the bone\nwidth: s.d. of the footprint along the skin\n"
             "normal_share: of the pull across the skin, 0 to 1\nprotrusion: sphincter, push outwards over "
             "pull along the fibres\n"
             "swelling: sphincter, push across the fibres over pull along them\n"
             "raises InvalidInput")
        .def_readonly("type", &Muscle::type)
        .def_readonly("insertion", &Muscle::insertion)
        .def_readonly("origin", &Muscle::origin)
        .def_readonly("width", &Muscle::width);

    py::class_<MuscleSurface>(m, "MuscleSurface", "The skin that muscles insert into.")
        .def(py::init<PointsIn, TrianglesIn, const std::vector<bool>&>(), py::arg("vertices").noconvert(),
             py::arg("triangles").noconvert(), "carries"_a,
             "vertices: (N, 3) float64, metres\ntriangles: (T, 3) int32\ncarries: T truth values")
        .def("distances", &MuscleSurface::distances, py::arg("sources").noconvert(), "limit"_a, release_gil(),
             "Along the skin from the nearest of the sources (K, 3), metres; infinite beyond the limit.")
        .def("forces", &MuscleSurface::forces, "muscle"_a, release_gil(),
             "Nodal forces (N, 3) at a total pull of 1 N, of a sphincter at a tension of 1 N/m.")
        .def_property_readonly("normals", &MuscleSurface::normals, "(N, 3), unit, at the vertices")
        .def_property_readonly("areas", &MuscleSurface::areas,
                               "(N,): a third of the triangles at each vertex, m^2");
    m.def("insertion_nodes", &insertion_nodes, "muscle"_a,
          "(K, 3) where fibres end in the skin: a point, points along a sheet's edge, a ring's own focus.");
    m.def("muscle_fibres", &muscle_fibres, "muscle"_a, "num_steps"_a,
          "Fibres in space, before projection onto the skin, (num_steps, 3) each, the origin first.");
    py::class_<MuscleLines>(m, "MuscleLines", "Lines from the bone to the skin; P points, metres.")
        .def(py::init([](const SkinPlaces& places, const Points& rest, const MatrixRows& bone,
                         const Eigen::VectorXd& share) { return MuscleLines{places, rest, bone, share}; }),
             "places"_a, "rest"_a, "bone"_a, "share"_a,
             "rest: (P, 3); bone: (J, 3P), how the bone under each point goes with the jaw's motions;\n"
             "share: (P,), 0 on the bone to 1 on the skin")
        .def("positions", &MuscleLines::positions, "vertices"_a, "jaw_values"_a, "lift"_a, release_gil(),
             "(P, 3) on a shape of the skin (N, 3), the jaw's motions at values (J,), lifted off the skin.");
}

}  // namespace mimetic::bindings
