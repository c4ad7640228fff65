// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/skin/corotational_skin.hpp>
#include <mimetic/skin/skin.hpp>
#include <mimetic/skin/skin_check.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <mimetic/skin/strain.hpp>

#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;
using ColumnsIn = const Eigen::Ref<const Eigen::MatrixXd>&;

namespace {

void bind_model(py::module_& m) {
    m.def("inverted_faces", &inverted_faces, py::arg("vertices").noconvert(),
          py::arg("triangles").noconvert(), release_gil(),
          "Triangles that are inverted relative to those around them, rising.\n\n"
          "vertices: (N, 3) float64, metres\ntriangles: (T, 3) int32");
    m.def("check_openings", &check_openings, py::arg("triangles").noconvert(), "num_openings"_a,
          "triangles_per_face"_a = 1, release_gil(),
          "Raises InvalidInput, naming a face, if the boundary has more closed loops than belong there.\n\n"
          "triangles: (T, 3) int32; num_openings: 1 for a head, its neck\n"
          "triangles_per_face: of the mesh whose faces are named, cut into triangles in order");

    py::class_<SkinMaterials>(m, "SkinMaterials", "Skin over bone, one value a vertex, SI units.")
        .def(py::init([](VectorIn young, VectorIn poisson, VectorIn thickness, VectorIn pre_stress,
                         VectorIn tangential, VectorIn normal) {
                 return SkinMaterials{young, poisson, thickness, pre_stress, tangential, normal};
             }),
             py::kw_only(), "young"_a, "poisson"_a, "thickness"_a, "pre_stress"_a, "tangential"_a, "normal"_a,
             "All (N,) float64: Pa, 1, m, Pa, N/m^3, N/m^3.")
        .def_readonly("young", &SkinMaterials::young)
        .def_readonly("poisson", &SkinMaterials::poisson)
        .def_readonly("thickness", &SkinMaterials::thickness)
        .def_readonly("pre_stress", &SkinMaterials::pre_stress)
        .def_readonly("tangential", &SkinMaterials::tangential)
        .def_readonly("normal", &SkinMaterials::normal);

    py::class_<SkinModel>(
        m, "SkinModel",
        "Static linear shell: membrane, bending, pre-stress and elastic attachment to the bone.")
        .def(py::init([](PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                         const CompressedRows& basis) {
                 return SkinModel(vertices, triangles, materials, basis.matrix);
             }),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "materials"_a, "basis"_a,
             release_gil(),
             "vertices: (N, 3) float64, metres\ntriangles: (T, 3) int32\n"
             "basis: CompressedRows, N x C, that make displacements of the\n"
             "    vertices from the unknowns\nraises InvalidInput, naming the face or vertex")
        .def_property_readonly("num_vertices", &SkinModel::num_vertices)
        .def_property_readonly("num_unknowns", &SkinModel::num_unknowns)
        .def("foundation_forces", &SkinModel::foundation_forces, py::arg("displacements").noconvert(),
             "Forces of the attachment on the vertices if the bone under them moves.\n\n"
             "displacements: (N, 3) float64, metres\nreturns: (N, 3), newtons")
        .def("loads", &SkinModel::loads, "forces"_a, release_gil(),
             "Loads on the unknowns.\n\nforces: (3N, M) float64, newtons, xyz interleaved\nreturns: (3C, M)")
        .def("solve", &SkinModel::solve, "forces"_a, release_gil(),
             "Static response.\n\nforces: (3N, M) float64, newtons, xyz interleaved\n"
             "returns: (3C, M), metres; raises InvalidInput where nothing holds the skin")
        .def("solve_loads", &SkinModel::solve_loads, "loads"_a, release_gil(),
             "The same for loads on the unknowns themselves.\n\nloads: (3C, M) float64, newtons");
}

void bind_strain(py::module_& m) {
    py::class_<StrainMeter>(m, "StrainMeter", "How a skin is stretched from rest to another shape.")
        .def(py::init<PointsIn, TrianglesIn>(), py::arg("rest").noconvert(), py::arg("triangles").noconvert(),
             release_gil(),
             "rest: (N, 3) float64\ntriangles: (T, 3) int32\nraises InvalidInput, naming the triangle")
        .def_property_readonly("num_vertices", &StrainMeter::num_vertices)
        .def("at_vertices", &StrainMeter::at_vertices, py::arg("vertices").noconvert(), release_gil(),
             "Strain of a shape at its vertices; the same for any position and rotation of it.\n\n"
             "vertices: (N, 3) float64\n"
             "returns: (N, 3): area, largest and smallest length over rest, less 1; 0 where no triangle is");
}

/// The mass matrix stays in the core: numpy has no sparse matrices.
struct SkinMass {
    Eigen::SparseMatrix<double> matrix;
};

void bind_steps(py::module_& m) {
    py::enum_<TimeScheme>(m, "TimeScheme")
        .value("newmark", TimeScheme::newmark)
        .value("backward_euler", TimeScheme::backward_euler);
    py::class_<DynamicsOptions>(
        m, "DynamicsOptions",
        "M u'' + D u' + K (u + p) = f with D = mass_damping M + stiffness_damping K and the internal\n"
        "variable p of a standard linear solid: p' + p / relaxation_time = relaxation_share u'.")
        .def(py::init([](TimeScheme scheme, double step, double mass_damping, double stiffness_damping,
                         double relaxation_share, double relaxation_time) {
                 const DynamicsOptions options{
                     scheme, step, mass_damping, stiffness_damping, relaxation_share, relaxation_time};
                 options.check();
                 return options;
             }),
             py::kw_only(), "scheme"_a = TimeScheme::newmark, "step"_a = DynamicsOptions{}.step,
             "mass_damping"_a = 0.0, "stiffness_damping"_a = 0.0, "relaxation_share"_a = 0.0,
             "relaxation_time"_a = DynamicsOptions{}.relaxation_time,
             "step: s; mass_damping: 1/s; stiffness_damping: s; relaxation_share: immediate over lasting\n"
             "stiffness, less one; relaxation_time: s. Raises InvalidInput: field, value, limit.")
        .def_readonly("scheme", &DynamicsOptions::scheme)
        .def_readonly("step", &DynamicsOptions::step)
        .def_readonly("mass_damping", &DynamicsOptions::mass_damping)
        .def_readonly("stiffness_damping", &DynamicsOptions::stiffness_damping)
        .def_readonly("relaxation_share", &DynamicsOptions::relaxation_share)
        .def_readonly("relaxation_time", &DynamicsOptions::relaxation_time);
    py::class_<SkinDynamics>(m, "SkinDynamics",
                             "Implicit steps in time of the whole skin, factored once for a step's length.")
        .def(py::init([](const SkinModel& model, const SkinMass& mass, const DynamicsOptions& options) {
                 return SkinDynamics(model.stiffness(), mass.matrix, options);
             }),
             "model"_a, "mass"_a, "options"_a = DynamicsOptions{}, release_gil(), "At rest and relaxed.")
        .def("start", &SkinDynamics::start, "displacement"_a, "velocity"_a, "load"_a, release_gil(),
             "Start there, relaxed, under this load.\n\nAll (3C,) float64: metres, m/s, newtons.")
        .def(
            "advance",
            [](SkinDynamics& dynamics, VectorIn load) { return dynamics.advance(load).displacement; },
            "load"_a, release_gil(),
            "One step.\n\nload: (3C,) newtons at its end, see SkinModel.loads\n"
            "returns: (3C,) displacement of the unknowns, metres")
        .def_property_readonly("displacement",
                               [](const SkinDynamics& dynamics) { return dynamics.state().displacement; })
        .def_property_readonly("velocity",
                               [](const SkinDynamics& dynamics) { return dynamics.state().velocity; })
        .def_property_readonly("energy", &SkinDynamics::energy, "Kinetic and elastic, J.");
}

void bind_reduced(py::module_& m) {
    py::class_<VibrationModes>(m, "VibrationModes", "Natural modes, lowest first.")
        .def_readonly("frequencies", &VibrationModes::frequencies, "(M,) Hz")
        .def_readonly("shapes", &VibrationModes::shapes, "(3C, M), of unit mass");
    m.def(
        "vibration_modes",
        [](const SkinModel& model, const SkinMass& mass, int num_modes) {
            return vibration_modes(model.stiffness(), mass.matrix, num_modes);
        },
        "model"_a, "mass"_a, "num_modes"_a, release_gil(),
        "The lowest modes of K phi = omega^2 M phi, by Lanczos iterations on the inverse (Spectra).\n"
        "Raises InvalidInput where nothing holds the skin.");
    py::class_<ReducedSkin>(
        m, "ReducedSkin",
        "The skin in time within the span of its static responses and its lowest natural modes.")
        .def(py::init([](const SkinModel& model, const SkinMass& mass, ColumnsIn loads, int num_modes,
                         const DynamicsOptions& options) {
                 return ReducedSkin(model.stiffness(), mass.matrix, loads, num_modes, options);
             }),
             "model"_a, "mass"_a, "loads"_a, "num_modes"_a, "options"_a = DynamicsOptions{}, release_gil(),
             "loads: (3C, L) float64, newtons, a column for each muscle or motion of a bone at value 1,\n"
             "see SkinModel.loads; num_modes: 0 or more")
        .def_property_readonly("num_values", &ReducedSkin::num_values)
        .def_property_readonly("shapes", &ReducedSkin::shapes, "(3C, R): unknowns, metres, of coordinates")
        .def_property_readonly("frequencies", &ReducedSkin::frequencies, "(R,) Hz, undamped")
        .def_property_readonly("coordinates", &ReducedSkin::coordinates, "(R,)")
        .def("reset", &ReducedSkin::reset, "At rest and relaxed.")
        .def("advance", &ReducedSkin::advance, "values"_a,
             "One step.\n\nvalues: (L,) at its end\nreturns: (R,) coordinates");
    py::class_<ReducedSurface>(m, "ReducedSurface",
                               "Displacements of places on the surface from reduced coordinates.")
        .def(py::init([](const CompressedRows& stencils, ColumnsIn shapes) {
                 return ReducedSurface(stencils.matrix, shapes);
             }),
             "stencils"_a, "shapes"_a, release_gil(), "stencils: CompressedRows, P x C; shapes: (3C, R)")
        .def("displacements", &ReducedSurface::displacements, "coordinates"_a,
             "returns: (P, 3) float32, metres, for (R,) coordinates");
}

void bind_corotational(py::module_& m) {
    py::class_<CorotationalSolution>(m, "CorotationalSolution")
        .def_readonly("unknowns", &CorotationalSolution::unknowns, "(3C,) metres")
        .def_readonly("iterations", &CorotationalSolution::iterations)
        .def_readonly("residual", &CorotationalSolution::residual, "residual force over the load")
        .def_readonly("converged", &CorotationalSolution::converged);
    py::class_<CorotationalSkin>(
        m, "CorotationalSkin",
        "The skin under large rotations: strain and curvature are measured in axes that turn with it.")
        .def(py::init([](PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                         const CompressedRows& basis) {
                 return CorotationalSkin(vertices, triangles, materials, basis.matrix);
             }),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "materials"_a, "basis"_a,
             release_gil(), "As SkinModel.")
        .def("energy", &CorotationalSkin::energy, "unknowns"_a, release_gil(),
             "Elastic energy, J, for (3C,) metres; infinite where a triangle is crushed.")
        .def("gradient", &CorotationalSkin::gradient, "unknowns"_a, release_gil(),
             "Forces that hold the skin there, (3C,) newtons, for (3C,) metres.")
        .def(
            "solve",
            [](const CorotationalSkin& skin, VectorIn forces, int max_iterations, double tolerance) {
                return skin.solve(forces, {max_iterations, tolerance});
            },
            "forces"_a, "max_iterations"_a = CorotationalOptions{}.max_iterations,
            "tolerance"_a = CorotationalOptions{}.tolerance, release_gil(),
            "Equilibrium with forces that keep their directions, by L-BFGS in the metric of the linear "
            "skin.\n\n"
            "forces: (3N,) float64, newtons, xyz interleaved; tolerance: of the residual force over the "
            "load\n"
            "returns: CorotationalSolution; raises InvalidInput where nothing holds the skin");
}

void bind_dynamics(py::module_& m) {
    py::class_<SkinMass>(m, "SkinMass", "Mass of the skin for the unknowns of its model.")
        .def(py::init([](const SkinModel& model, PointsIn vertices, TrianglesIn triangles,
                         VectorIn surface_density) {
                 return SkinMass{skin_mass(model, vertices, triangles, surface_density)};
             }),
             "model"_a, py::arg("vertices").noconvert(), py::arg("triangles").noconvert(),
             "surface_density"_a, release_gil(),
             "surface_density: (N,) float64, kg/m^2, the skin and what moves with it");
    bind_steps(m);
    bind_reduced(m);
    bind_corotational(m);
}

}  // namespace

void bind_skin(py::module_& m) {
    bind_model(m);
    bind_strain(m);
    bind_dynamics(m);
}

}  // namespace mimetic::bindings
