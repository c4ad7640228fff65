// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/contact/skin_contact.hpp>
#include <mimetic/contact/slits.hpp>
#include <optional>

#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

py::array_t<int> rows_array(const std::vector<int>& rows) {
    return py::array_t<int>(static_cast<py::ssize_t>(rows.size()), rows.data());
}

SkinContact make_contact(PointsIn rest, const CompressedRows& stencils, const std::vector<Slit>& slits,
                         const std::vector<EyeRest>& eyes, const SkinModel& model,
                         const std::vector<bool>& free, const std::vector<int>& moves_with,
                         const std::vector<int>& read, const std::optional<CompressedRows>& carrier) {
    const py::gil_scoped_release release;
    const TouchPoints touch{rest, stencils.matrix, slits};
    return SkinContact(touch, eyes,
                       {model, free, moves_with, read, carrier ? carrier->matrix : SparseRows{}});
}

py::tuple shapes_of_contact(const SkinContact& contact,
                            const std::vector<std::pair<MatrixRows, MatrixRows>>& parts,
                            const std::optional<Progress>& progress) {
    ContactShapes shapes;
    {
        const py::gil_scoped_release release;
        std::vector<MotionPart> motion;
        for (const auto& [values, modes] : parts) {
            motion.push_back({values, modes});
        }
        shapes = contact_shapes(contact, motion, progress.value_or(Progress{}));
    }
    return py::make_tuple(std::move(shapes.values), std::move(shapes.offsets));
}

void bind_slits(py::module_& m) {
    m.def("lip_slit", &lip_slit, "vertices"_a, "triangles"_a, "surface"_a, "margin"_a, "inner"_a, "size"_a,
          release_gil(),
          "Slit of the lips as far as they can touch, the lining behind them included.\n\n"
          "surface: of all triangles; margin: (K, 3), where skin becomes lining; inner: (2, 3), the middle "
          "of\nthe upper and of the lower lip; size: of the head, the template's being 1");
    m.def("lid_slit", &lid_slit, "vertices"_a, "margin"_a, "corners"_a, "size"_a,
          "Slit of one eye's lids without the corners that they share.\n\n"
          "margin: vertices on the edge of both; corners: (2, 3), the inner and the outer one");
    m.def(
        "number_slits",
        [](const std::vector<Slit>& slits, const std::vector<bool>& kept) {
            auto [vertices, numbered] = number_slits(slits, kept);
            return py::make_tuple(rows_array(vertices), std::move(numbered));
        },
        "slits"_a, "kept"_a,
        "The slits' vertices that are kept (C,), and slits by their indices among them.");
}

void bind_skin_contact(py::module_& m) {
    py::class_<EyeRest>(m, "EyeRest", "Skin that slides on an eye; metres, head frame.")
        .def(py::init([](const Eigen::Vector3d& centre, const std::vector<int>& vertices, PointsIn rest,
                         const Eigen::VectorXd& share,
                         double sink) { return EyeRest{centre, vertices, rest, share, sink}; }),
             "centre"_a, "vertices"_a, "rest"_a, "share"_a, "sink"_a,
             "vertices: E base vertices; rest: (E, 3); share: (E,) of sinking that is put back; sink: left "
             "alone")
        .def_readonly("centre", &EyeRest::centre)
        .def_property_readonly("vertices", [](const EyeRest& self) { return rows_array(self.vertices); })
        .def_readonly("rest", &EyeRest::rest)
        .def_readonly("share", &EyeRest::share)
        .def_readonly("sink", &EyeRest::sink);
    m.def("rest_on_eye", &rest_on_eye, "surface"_a, "margin"_a, "rest"_a, "centre"_a, "reach"_a, "size"_a,
          release_gil(),
          "EyeRest of lids.\n\nsurface: of the whole skin; margin: (K, 3), the edge of the lids; rest: (S, "
          "3)\ncontrol vertices; reach: metres along the skin where lids end; size: of the head");
    py::class_<SkinContact>(
        m, "SkinContact",
        "Frictionless contact between the lips and between the lids of a head, quasi-static.\n\n"
        "Displacements are in the head frame, or in that of `turned`; metres.")
        .def(py::init(&make_contact), py::kw_only(), "rest"_a, "stencils"_a, "slits"_a, "eyes"_a, "model"_a,
             "free"_a, "moves_with"_a, "read"_a, "carrier"_a = py::none(),
             "rest: (C, 3), the points that can touch; stencils: CompressedRows of the C x B matrix that "
             "makes\nthem of base vertices; model: its unknowns are those of its vertices that are `free` "
             "(S,); "
             "moves_with: (V,),\nthe base vertex that each of the head's goes with, -1 for none; read: (B,), "
             "the head's vertex that is\neach base vertex; carrier: CompressedRows (B, S) that make the base "
             "vertices' motion of the model's,\nnone if they are the same. Raises InvalidInput.")
        .def_property_readonly(
            "vertices", [](const SkinContact& self) { return rows_array(self.vertices()); },
            "(K,) of the head, that are tested")
        .def_property_readonly(
            "moved", [](const SkinContact& self) { return rows_array(self.moved()); },
            "(W,) of the head, that contact may displace")
        .def_property_readonly("num_slits", &SkinContact::num_slits)
        .def("correction", &SkinContact::correction, "displacement"_a, release_gil(),
             "(W, 3) float32 of `moved` that separates lips and lids; None if nothing overlaps.\n\n"
             "displacement: (K, 3), of `vertices`")
        .def("relieve", &SkinContact::relieve, "displacement"_a, release_gil(),
             "The displacement (V, 3) with lips and lids separated; unchanged where nothing overlaps.")
        .def("gaps", &SkinContact::gaps, "displacement"_a, release_gil(),
             "Gaps of the overlaps at a displacement (V, 3), all negative.")
        .def(
            "depth",
            [](const SkinContact& self, PointsIn displacement) {
                const Eigen::VectorXd gaps = self.gaps(displacement);
                return gaps.size() ? std::max(0., -gaps.minCoeff()) : 0.;
            },
            "displacement"_a, release_gil(), "Largest penetration of lips or lids, metres.")
        .def("turned", &SkinContact::turned, "linear"_a,
             "The same contact for displacements in another frame: linear (3, 3) @ those of this.");
    m.def("contact_shapes", &shapes_of_contact, "contact"_a, "parts"_a, "progress"_a = py::none(),
          "Few shapes whose sums are a take's corrections: values (N, S), offsets (S, 3W).\n\n"
          "parts: values (N, M) and modes at the contact's vertices (M, 3K), metres; progress: called with "
          "the\nfraction done, false ends the work with the frames so far. Raises InvalidInput.");
    m.def(
        "shapes_of_corrections",
        [](const MatrixRows& corrections, const std::vector<Eigen::Index>& frames, Eigen::Index num_frames) {
            ContactShapes shapes;
            {
                const py::gil_scoped_release release;
                shapes = shapes_of_corrections(corrections, frames, num_frames);
            }
            return py::make_tuple(std::move(shapes.values), std::move(shapes.offsets));
        },
        "corrections"_a, "frames"_a, "num_frames"_a,
        "Few shapes whose sums are corrections (C, 3W), metres: values (N, S), offsets (S, 3W).\n\n"
        "frames: C, from 0, that the corrections are of; the values of others are 0. Raises InvalidInput.");
}

}  // namespace

void bind_contact(py::module_& m) {
    py::class_<Slit>(m, "Slit", "Two rims across a slit that can touch, by indices of points.")
        .def(py::init([](std::vector<int> upper, std::vector<int> lower, const Triangles& triangles) {
                 return Slit{std::move(upper), std::move(lower), triangles};
             }),
             "upper"_a, "lower"_a, "triangles"_a = Triangles(0, 3),
             "triangles: (T, 3) int32 of both surfaces; none if the rims are lines by x")
        .def_readonly("upper", &Slit::upper)
        .def_readonly("lower", &Slit::lower)
        .def_readonly("triangles", &Slit::triangles);
    bind_slits(m);
    bind_skin_contact(m);
}

}  // namespace mimetic::bindings
