// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/register/foreign_skin.hpp>
#include <mimetic/register/head_parts.hpp>
#include <mimetic/register/loose_parts.hpp>
#include <mimetic/register/registration.hpp>
#include <mimetic/register/worn.hpp>

#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

using LongVector = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
using FlagArray = py::array_t<bool, py::array::c_style | py::array::forcecast>;

std::vector<bool> flags_of(const FlagArray& array) {
    return std::vector<bool>(array.data(), array.data() + array.size());
}

py::array_t<bool> array_of_flags(const std::vector<bool>& flags) {
    py::array_t<bool> array(static_cast<py::ssize_t>(flags.size()));
    std::copy(flags.begin(), flags.end(), array.mutable_data());
    return array;
}

py::array_t<int> array_of_rows(const std::vector<int>& rows) {
    return py::array_t<int>(static_cast<py::ssize_t>(rows.size()), rows.data());
}

void bind_meshes(py::module_& m) {
    m.def(
        "cut_faces",
        [](PointsIn points, const Eigen::Ref<const LongQuads>& faces) {
            CutFaces cut = cut_faces(points, faces);
            return py::make_tuple(std::move(cut.triangles), std::move(cut.face));
        },
        py::arg("points").noconvert(), "faces"_a,
        "Triangles (T, 3) and the face of each (T,); quads are cut along their shorter diagonal.\n\n"
        "points: (V, 3) float64; faces: (F, 4) int64, a triangle ends in -1; raises InvalidInput");
    m.def(
        "cut_polygons",
        [](PointsIn points, const Eigen::Ref<const LongVector>& starts,
           const Eigen::Ref<const LongVector>& corners) {
            PolygonPieces pieces = cut_polygons(points, {starts.data(), starts.data() + starts.size()},
                                                {corners.data(), corners.data() + corners.size()});
            return py::make_tuple(std::move(pieces.faces), std::move(pieces.polygon));
        },
        py::arg("points").noconvert(), "starts"_a, "corners"_a,
        "Triangles and quads (F, 4), a triangle ends in -1, and the polygon of each (F,).\n\n"
        "starts: the first corner of each polygon; corners: vertices. Polygons of five and more are cut "
        "from\ntheir corner that leaves no sliver; raises InvalidInput");
    m.def(
        "place_mesh",
        [](PointsIn points, const Eigen::Ref<const LongQuads>& faces, const Eigen::Matrix4d& matrix) {
            PlacedMesh placed = place_mesh(points, faces, matrix);
            return py::make_tuple(std::move(placed.vertices), std::move(placed.faces),
                                  placed.object_from_head);
        },
        "points"_a, "faces"_a, "metres_from_object"_a,
        "An object's mesh in metres: vertices (V, 3), faces (F, 4), reversed if it is mirrored, and "
        "(3, 3)\nobject from head, of displacements. Raises InvalidInput if it is scaled to nothing.");
    m.def("placed_points", &placed_points, "points"_a, "head_from_part"_a,
          "Points (V, 3) of a part of a head in the head's frame. Raises InvalidInput if it is scaled to "
          "nothing.");
    m.def("moved_in_part", &moved_in_part, "displacements"_a, "head_from_part"_a,
          "Displacements (V, 3) in the head's frame as the part's own has them. Raises InvalidInput.");
    m.def("is_mirror", &is_mirror, "head_from_part"_a,
          "Whether the part's frame (4, 4) is a mirror image of the head's.");
    m.def("lies_in_box", &lies_in_box, "head"_a, "part"_a,
          "Whether points (P, 3) are small beside a head's (V, 3) and lie in its box.");
    py::class_<HeadViews>(m, "HeadViews", "A head as it is seen from 26 directions.")
        .def(py::init<PointsIn, TrianglesIn, const Eigen::Matrix4d&>(), "points"_a, "triangles"_a,
             "metres_from_points"_a, release_gil(),
             "points: (V, 3), any axes and unit; triangles: (T, 3) int32, outward; metres_from_points: (4, "
             "4);\n"
             "raises InvalidInput")
        .def(
            "wears", &HeadViews::wears, "part"_a, release_gil(),
            "Whether a small mesh (P, 3) lies before the skin, as glasses and hats do; not what lies behind\n"
            "it or in its openings, nearer to it than 8 mm, or is a ball or a cap of one.");
    py::class_<ForeignSkin>(m, "ForeignSkin",
                            "The skin of a head's mesh that is not the template's, in the template's frame.")
        .def_readwrite("vertices", &ForeignSkin::vertices, "(N, 3), metres")
        .def_readonly("triangles", &ForeignSkin::triangles, "(T, 3)")
        .def_readonly("face", &ForeignSkin::face, "(T,), the caller's face of each")
        .def_readonly("landmarks", &ForeignSkin::landmarks, "(L, 3)")
        .def_readonly("skin_vertex", &ForeignSkin::skin_vertex,
                      "(V,), of each of the caller's vertices; -1 on loose parts")
        .def_readonly("user_vertices", &ForeignSkin::user_vertices, "(V, 3), all of the caller's vertices")
        .def_readonly("loose", &ForeignSkin::loose, "(V,), number of the loose part; -1 on the skin")
        .def_readonly("num_collapsed", &ForeignSkin::num_collapsed,
                      "faces without extent that were left out");
    m.def(
        "read_foreign_skin",
        [](PointsIn points, const Triangles& triangles, const Eigen::VectorXi& face,
           const std::vector<std::string>& names, const Points& places, const std::vector<int>& front,
           const Similarity& user_from_skin) {
            const py::gil_scoped_release release;
            return read_foreign_skin(points, {triangles, face}, {names, places, front}, user_from_skin);
        },
        py::arg("points").noconvert(), "triangles"_a, "face"_a, "names"_a, "places"_a, "front"_a,
        "user_from_skin"_a,
        "The connected part that most landmarks lie on, points at the same place joined.\n\n"
        "triangles, face: of cut_faces; names, places: landmarks, (L, 3); front: rows of those that look\n"
        "forwards; raises InvalidInput, naming the caller's face or vertex");
    m.def(
        "find_holes",
        [](const ForeignSkin& skin, const FlagArray& free, PointsIn places, VectorIn reaches) {
            return find_holes(skin, flags_of(free), places, reaches);
        },
        "skin"_a, "free"_a, "places"_a, "reaches"_a,
        "The caller's face beside each hole in free skin (N,), farther from all places (K, 3) than their "
        "reaches.");
    m.def(
        "find_seam",
        [](PointsIn vertices, TrianglesIn triangles, PointsIn inner, PointsIn corners) {
            return array_of_flags(find_seam(vertices, triangles, inner, corners));
        },
        "vertices"_a, "triangles"_a, "inner"_a, "corners"_a,
        "(N,) the seam of a mouth that is not cut open; all false if it is.\n\n"
        "inner: (2, 3), inner edges of the upper and the lower lip; corners: (2, 3), of the mouth");
}

void bind_loose(py::module_& m) {
    py::enum_<TemplatePart>(m, "TemplatePart")
        .value("other", TemplatePart::other)
        .value("lower_jaw", TemplatePart::lower_jaw)
        .value("upper_teeth", TemplatePart::upper_teeth)
        .value("left_eye", TemplatePart::left_eye)
        .value("right_eye", TemplatePart::right_eye);
    py::class_<LooseParts>(m, "LooseParts", "Teeth, eyes, lashes, hair: what is no skin. V vertices.")
        .def_property_readonly(
            "on_jaw", [](const LooseParts& self) { return array_of_flags(self.on_jaw); }, "(V,)")
        .def(
            "on_eye",
            [](const LooseParts& self, int side) {
                return array_of_flags(self.on_eye.at(static_cast<std::size_t>(side)));
            },
            "side"_a, "(V,); side: 0 left, 1 right")
        .def(
            "ball_centre",
            [](const LooseParts& self, int side) -> std::optional<Eigen::Vector3d> {
                const auto& ball = self.balls.at(static_cast<std::size_t>(side));
                return ball ? std::optional(ball->centre) : std::nullopt;
            },
            "side"_a, "(3,), of an eyeball that is modelled in full; else None")
        .def_property_readonly(
            "following", [](const LooseParts& self) { return array_of_rows(self.following); },
            "vertices that move with the skin")
        .def_readonly("roots", &LooseParts::roots, "the skin's vertex of each that follows")
        .def_readonly("num_left", &LooseParts::num_left, "vertices that are too many to follow");
    m.def(
        "sort_loose_parts",
        [](const ForeignSkin& skin, PointsIn laid, const Eigen::VectorXi& parts) {
            std::vector<TemplatePart> like;
            for (const int part : parts) {
                like.push_back(static_cast<TemplatePart>(part));
            }
            const py::gil_scoped_release release;
            return sort_loose_parts(skin, laid, like);
        },
        "skin"_a, "laid"_a, "parts"_a,
        "laid: (V', 3) float64, the template's vertices on the head; parts: (V',) values of TemplatePart");
    m.def("guess_places", &guess_places, "points"_a, "usual_skin"_a, "usual_places"_a, "nose"_a,
          release_gil(),
          "(L, 3) where landmarks may be on a head (V, 3) that looks along -y, its top in z; metres.\n\n"
          "usual_skin: (S, 3), usual_places: (L, 3), of a usual head; nose: row of the tip of the nose");
}

}  // namespace

void bind_register(py::module_& m) {
    bind_meshes(m);
    bind_loose(m);
    py::class_<LippedSurface>(
        m, "LippedSurface",
        "A skin whose nearest-point search distinguishes inside from outside, and the lips.")
        .def(py::init<PointsIn, TrianglesIn, const MuscleSurface&, PointsIn>(),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "surface"_a, "lips"_a,
             release_gil(),
             "vertices: (N, 3) float64, metres; triangles: (T, 3) int32; surface: of all of them\n"
             "lips: (2, 3), points of the upper and the lower lip's vermilion border")
        .def("find", &LippedSurface::find, "points"_a, "normals"_a, "lip"_a, release_gil(),
             "SkinPlaces nearest to points (P, 3) with outward normals (P, 3) and lips (P,), 1 upper to -1.")
        .def_property_readonly("vertices", &LippedSurface::vertices)
        .def_property_readonly("normals", &LippedSurface::normals)
        .def_property_readonly("lip", &LippedSurface::lip, "(N,), 1 on the upper lip to -1 on the lower");
    m.def(
        "carrier_rows",
        [](const SkinPlaces& places, const CompressedRows& stencils, double reach) {
            return CompressedRows{carrier_rows(places, stencils.matrix, reach)};
        },
        "places"_a, "stencils"_a, "reach"_a, release_gil(),
        "CompressedRows (P, S): how places on a refined skin (stencils, N x S) move with control vertices,\n"
        "the less the farther off they are, not at all from `reach` metres on. Raises InvalidInput.");
    m.def("warp_points", &warp_points, "points"_a, "source"_a, "target"_a, release_gil(),
          "Points (P, 3) moved as sources (K, 3) go to targets; raises InvalidInput.");
    m.def(
        "draw_to_surface",
        [](PointsIn neutral, const LippedSurface& skin, const FlagArray& outer,
           const CompressedRows& stencils, const std::vector<int>& held,
           const std::vector<std::pair<std::vector<int>, std::vector<int>>>& followers, PointsIn targets,
           const LippedSurface& surface, double reach) {
            LaidTemplate laid{neutral, skin, flags_of(outer), stencils.matrix, held, {}};
            for (const auto& [edge, vertices] : followers) {
                laid.followers.push_back({edge, vertices});
            }
            const py::gil_scoped_release release;
            return draw_to_surface(laid, targets, surface, reach);
        },
        py::kw_only(), "neutral"_a, "skin"_a, "outer"_a, "stencils"_a, "held"_a, "followers"_a, "targets"_a,
        "surface"_a, "reach"_a,
        "(V, 3): a template-shaped head after its skin was drawn to what lies within reach, metres.\n\n"
        "skin: of the refined vertices; outer: (N,), which are no linings; held: landmarks' vertices,\n"
        "targets: (L, 3), their places; followers: (edge, vertices) that go with the mean of an edge.\n"
        "Raises InvalidInput.");
}

}  // namespace mimetic::bindings
