// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/surface/surface.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

template <typename Value>
py::array_t<Value> copy_array(const Value* data, Eigen::Index size) {
    return py::array_t<Value>(static_cast<py::ssize_t>(size), data);
}

/// (indptr, indices, weights) of a compressed row matrix.
py::tuple to_csr(const SparseRows& matrix) {
    return py::make_tuple(copy_array(matrix.outerIndexPtr(), matrix.outerSize() + 1),
                          copy_array(matrix.innerIndexPtr(), matrix.nonZeros()),
                          copy_array(matrix.valuePtr(), matrix.nonZeros()));
}

}  // namespace

void bind_surface(py::module_& m) {
    py::class_<LimitSurface>(
        m, "LimitSurface",
        "Places on the Catmull-Clark limit surface of a quad mesh, linear in its vertices.")
        .def(py::init<QuadsIn, int, IndicesIn, Points2In>(), py::arg("faces").noconvert(), "num_vertices"_a,
             py::arg("face_index").noconvert(), py::arg("st").noconvert(), release_gil(),
             "faces: (F, 4) int32\nface_index: (P,) int32, the face of each place\n"
             "st: (P, 2) float64 in [0, 1]; a face's vertices lie at (0, 0), (1, 0), (1, 1), (0, 1)\n"
             "raises InvalidInput")
        .def_property_readonly("num_points", &LimitSurface::num_points)
        .def_property_readonly("num_vertices", &LimitSurface::num_vertices)
        .def("positions", &LimitSurface::positions, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (P, 3)")
        .def("normals", &LimitSurface::normals, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (P, 3), unit, outwards; zero without a tangent plane")
        .def(
            "stencils", [](const LimitSurface& self) { return to_csr(self.position_stencils()); },
            "Compressed rows (indptr, indices, weights) of the P x V matrix of positions.")
        .def(
            "tangent_stencils",
            [](const LimitSurface& self) {
                return py::make_tuple(to_csr(self.s_tangent_stencils()), to_csr(self.t_tangent_stencils()));
            },
            "The same for d position / d s and d position / d t.");

    py::class_<SubdividedMesh>(
        m, "SubdividedMesh",
        "A quad mesh refined `levels` times, its vertices on the limit surface; refined "
        "vertex i < num_vertices is the limit of control vertex i.")
        .def(py::init<QuadsIn, int, int>(), py::arg("faces").noconvert(), "num_vertices"_a, "levels"_a,
             release_gil(), "faces: (F, 4) int32\nlevels: 0 to 5\nraises InvalidInput")
        .def_property_readonly("num_refined", &SubdividedMesh::num_refined)
        .def_property_readonly("faces", &SubdividedMesh::faces, "(F * 4^levels, 4) int32")
        .def_property_readonly("parent_face", &SubdividedMesh::parent_face, "(F * 4^levels,) int32")
        .def("positions", &SubdividedMesh::positions, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (num_refined, 3)")
        .def("normals", &SubdividedMesh::normals, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (num_refined, 3), unit, outwards")
        .def(
            "stencils", [](const SubdividedMesh& self) { return to_csr(self.stencils()); },
            "Compressed rows (indptr, indices, weights) of the num_refined x V matrix.");
}

}  // namespace mimetic::bindings
