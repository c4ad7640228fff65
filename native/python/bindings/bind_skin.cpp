// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/skin/skin.hpp>
#include <mimetic/skin/skin_check.hpp>

#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;
using ColumnsIn = const Eigen::Ref<const Eigen::MatrixXd>&;

void bind_skin(py::module_& m) {
    m.def("inverted_faces", &inverted_faces, py::arg("vertices").noconvert(),
          py::arg("triangles").noconvert(), release_gil(),
          "Triangles that lie turned over among those around them, rising.\n\n"
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
                         const CompressedRows& basis, int num_unknowns) {
                 return SkinModel(vertices, triangles, materials, to_sparse(basis, num_unknowns));
             }),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "materials"_a, "basis"_a,
             "num_unknowns"_a, release_gil(),
             "vertices: (N, 3) float64, metres\ntriangles: (T, 3) int32\n"
             "basis: compressed rows (indptr, indices, weights) of the N x C matrix that makes displacements "
             "of the\n"
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

}  // namespace mimetic::bindings
