// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/attach.hpp>
#include <mimetic/muscles/skin_mesh.hpp>
#include <mimetic/skin/unfold.hpp>

#include "compressed_rows.hpp"
#include "stacks.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;
using FacesIn = const Eigen::Ref<const Eigen::VectorXi>&;

namespace {

void bind_checks(py::module_& m) {
    m.def(
        "unfold",
        [](PointsIn vertices, const std::function<Triangles(PointsIn)>& split, FacesIn face) {
            Unfolded unfolded = unfold(vertices, split, face);
            return py::make_tuple(std::move(unfolded.vertices), unfolded.inverted, unfolded.farthest);
        },
        py::arg("vertices").noconvert(), "split"_a, "face"_a,
        "Vertices of a mesh without inverted triangles.\n\n"
        "vertices: (N, 3) float64, metres; split: the mesh's triangles for such vertices; face: T, of the "
        "head,\nfor each triangle\n"
        "returns: vertices, faces that were inverted (rising), metres by which a vertex was moved at most\n"
        "raises InvalidInput, naming a face, if smoothing does not help");
    m.def("check_areas", &check_areas, py::arg("vertices").noconvert(), py::arg("triangles").noconvert(),
          "face"_a, release_gil(),
          "Raises InvalidInput on a triangle without area, naming its face of the head (face: T).");
    m.def("split_quads", &split_quads, "vertices"_a, "quads"_a,
          "(2F, 3) int32: triangles 2i and 2i + 1 of quad i, cut along its shorter diagonal.\n\n"
          "vertices: (V, 3) float64; quads: (F, 4) int32");
    m.def(
        "keep_columns",
        [](const CompressedRows& rows, const Flags& kept) {
            return CompressedRows{keep_columns(rows.matrix, kept)};
        },
        "rows"_a, "kept"_a, "The matrix without the columns where `kept` is false.");
    m.def("smooth_step", py::vectorize(&smooth_step), "value"_a, "0 below 0, 1 above 1, with no kink.");
    m.def("quad_normals", &quad_normals, py::arg("vertices"), py::arg("quads"),
          "Unit normals of vertices (V, 3): of the quads around each, by their areas; 0 without any.");
}

void bind_mesh(py::module_& m) {
    py::class_<TemplateSkin, std::shared_ptr<TemplateSkin>>(m, "TemplateSkin",
                                                            "The template's skin, refined; made once.")
        .def(py::init([](Points vertices, Quads faces, int num_skin_vertices, int num_skin_faces,
                         Eigen::VectorXi part, std::vector<std::string> part_names, Eigen::VectorXi region,
                         std::vector<std::string> region_names, Eigen::VectorXi landmark_vertices,
                         std::vector<std::string> landmark_names, Points eye_centers, Points jaw_hinge) {
                 return std::make_shared<TemplateSkin>(
                     TemplateMesh{std::move(vertices), std::move(faces), num_skin_vertices, num_skin_faces,
                                  std::move(part), std::move(part_names), std::move(region),
                                  std::move(region_names), std::move(landmark_vertices),
                                  std::move(landmark_names), std::move(eye_centers), std::move(jaw_hinge)});
             }),
             py::kw_only(), "vertices"_a, "faces"_a, "num_skin_vertices"_a, "num_skin_faces"_a, "part"_a,
             "part_names"_a, "region"_a, "region_names"_a, "landmark_vertices"_a, "landmark_names"_a,
             "eye_centers"_a, "jaw_hinge"_a, release_gil(),
             "As in mimetic.template.face_template.FaceTemplate.");
    py::class_<SkinMesh, std::shared_ptr<SkinMesh>>(m, "SkinMesh",
                                                    "A neutral head's skin, refined and cut into triangles.")
        .def(py::init([](std::shared_ptr<TemplateSkin> shared, PointsIn neutral) {
                 return std::make_shared<SkinMesh>(std::move(shared), neutral);
             }),
             "shared"_a, py::arg("neutral").noconvert(), release_gil(),
             "neutral: (V, 3) float64, metres, head frame, of the template's mesh; raises InvalidInput")
        .def_property_readonly("neutral", &SkinMesh::neutral, "(V, 3)")
        .def_property_readonly("vertices", &SkinMesh::vertices, "(N, 3); smoothed where faces were inverted")
        .def_property_readonly("triangles", &SkinMesh::triangles, "(T, 3) int32")
        .def_property_readonly("normals", &SkinMesh::normals, "(N, 3), unit")
        .def_property_readonly(
            "refinement",
            [](const SkinMesh& self) -> const SubdividedMesh& { return self.shared().refinement(); },
            py::return_value_policy::reference_internal)
        .def_property_readonly("stencils",
                               [](const SkinMesh& self) { return CompressedRows{self.stencils()}; })
        .def(
            "stencil_rows_at",
            [](const SkinMesh& self, const std::vector<int>& vertices) {
                return CompressedRows{keep_rows(self.stencils(), vertices)};
            },
            "vertices"_a, "The rows of the stencils for some refined vertices.")
        .def_property_readonly(
            "seen_from_front", [](const SkinMesh& self) { return array_of(self.seen_from_front()); },
            "Refined vertices of the outer skin that do not face backwards, rising.")
        .def_property_readonly("inverted_faces", &SkinMesh::inverted_faces,
                               "Faces of the head that were inverted, and are smoothed.")
        .def_property_readonly("smoothed_by", &SkinMesh::smoothed_by, "Metres, at most.")
        .def_property_readonly("surface", &SkinMesh::surface,
                               "The outer skin, on which muscles act and distances run.")
        .def_property_readonly("whole_surface", &SkinMesh::whole_surface,
                               "The outer skin with mouth cavity and eye sockets.")
        .def_property_readonly("local_scale", &SkinMesh::local_scale,
                               "(S,): local scale of this skin relative to the template's.")
        .def_property_readonly("size", &SkinMesh::size, "Scale of this head relative to the template.")
        .def(
            "in_region",
            [](const SkinMesh& self, const std::string& name) { return self.shared().in_region(name); },
            "name"_a, "(S,) truth values; raises InvalidInput")
        .def(
            "vertices_between",
            [](const SkinMesh& self, const std::string& part, const std::string& other) {
                return array_of(self.shared().vertices_between(part, other));
            },
            "part"_a, "other"_a,
            "Control vertices that faces of both parts share: the margin of the lids, of the lips.")
        .def("landmark", &SkinMesh::landmark, "name"_a,
             "Vertex of a landmark; a paired one by its full name, such as mouth_corner.L.");
    py::class_<Place>(m, "Place", "A point fixed to a refined vertex of the skin.")
        .def_readonly("vertex", &Place::vertex)
        .def_readonly("offset", &Place::offset, "(3,) from the vertex, along the skin, m on the template")
        .def_readonly("depth", &Place::depth, "inwards from the skin, m on the template")
        .def("position", &Place::position, "mesh"_a, "(3,) on a head")
        .def("scale", &Place::scale, "mesh"_a, "Scale of lengths here relative to the template.");
    m.def(
        "find_place",
        [](const SkinMesh& mesh, std::string anchor, double x, double y, double depth, char side) {
            return find_place(mesh, {std::move(anchor), x, y, depth}, side);
        },
        "mesh"_a, "anchor"_a, "x"_a, "y"_a, "depth"_a, "side"_a,
        "The place on the skin that lies x, y millimetres from a landmark as seen from the front.\n\n"
        "mesh: the template's own; anchor: a landmark's name without .L/.R; x: away from the midline on "
        "side\n"
        "\"L\" or \"R\"; depth: mm");
}

void bind_jaw(py::module_& m) {
    py::class_<Jaw>(m, "Jaw", "The mandible: turns about the condyles; what is fixed to it follows.")
        .def(py::init([](std::shared_ptr<SkinMesh> mesh) { return Jaw(std::move(mesh)); }), "mesh"_a,
             py::keep_alive<1, 2>(), release_gil())
        .def_property_readonly("hinge", &Jaw::hinge, "(3,)")
        .def_property_readonly(
            "rigid_vertices", [](const Jaw& jaw) { return array_of(jaw.rigid_vertices()); },
            "Control vertices that are fixed to the bone: lower teeth, tongue.")
        .def(
            "motion",
            [](const Jaw& jaw, const std::string& name, PointsIn points) {
                return jaw.motion(jaw_motion(name), points);
            },
            "name"_a, "points"_a, "Displacement of points of the bone, (K, 3), at value 1.")
        .def(
            "under_skin",
            [](const Jaw& jaw, const std::string& name) { return jaw.under_skin(jaw_motion(name)); },
            "name"_a, release_gil(),
            "Displacement of the bone under each refined skin vertex, (N, 3), at value 1.")
        .def_property_readonly("influence", &Jaw::influence,
                               "(N,): 0 (skull) to 1 (jaw) for the bone under each refined skin vertex.");
}

void bind_eyes(py::module_& m) {
    py::class_<EyeFrame>(m, "EyeFrame",
                         "One eye: centre, axis through which its lids turn, and the vertices that follow.")
        .def(py::init([](std::shared_ptr<SkinMesh> mesh, char side,
                         const std::optional<Eigen::Vector3d>& own_centre) {
                 return EyeFrame(std::move(mesh), side, own_centre);
             }),
             "mesh"_a, "side"_a, "own_centre"_a = py::none(), py::keep_alive<1, 2>(),
             "own_centre: (3,), of an eyeball that is not the template's")
        .def_property_readonly(
            "mesh", [](const EyeFrame& frame) { return std::const_pointer_cast<SkinMesh>(frame.mesh); })
        .def_readonly("side", &EyeFrame::side, "\"L\" or \"R\"")
        .def_readonly("centre", &EyeFrame::centre, "(3,)")
        .def_readonly(
            "axis", &EyeFrame::axis,
            "(3,) from the inner to the outer corner (left eye; the right eye's points inwards): a\n"
            "positive angle turns the front of the eye down")
        .def_property_readonly(
            "margin", [](const EyeFrame& frame) { return array_of(frame.margin); },
            "Control vertices on the edge of this eye's lids.")
        .def(
            "polar",
            [](const EyeFrame& frame, PointsIn points) {
                EyeFrame::Polar at = frame.polar(points);
                return py::make_tuple(std::move(at.along), std::move(at.elevation), std::move(at.radius));
            },
            "points"_a, "Position along the axis (m), elevation (radians), distance from the axis (m).");
    py::class_<EyeLids>(m, "EyeLids",
                        "Upper lid closing onto the lower one, lower lid rising: both turn about the eye.")
        .def(py::init<EyeFrame>(), "frame"_a, py::keep_alive<1, 2>())
        .def_property_readonly("frame", &EyeLids::frame)
        .def_property_readonly("upper", [](const EyeLids& lids) { return array_of(lids.upper()); })
        .def_property_readonly("lower", [](const EyeLids& lids) { return array_of(lids.lower()); })
        .def("opening", &EyeLids::opening, "along"_a,
             "Angle between the margins, radians, by the position along the axis; 0 at the corners.")
        .def(
            "angles", [](const EyeLids& lids) { return std::vector{lids.upper_angle(), lids.lower_angle()}; },
            release_gil(),
            "How far the skin turns about the eye with the upper and the lower lid, (S,) radians each.")
        .def("turn", &EyeLids::turn, "angle"_a, release_gil(),
             "(V, 3): skin turned about the eye by angles (S, down), lashes with their roots.");
    m.def("rotate", &rotate, "points"_a, "centre"_a, "axis"_a, "angles"_a,
          "Points (K, 3) turned about an axis (unit) through a centre by angles (K), radians.");
    m.attr("LID_REACH") = EyeLids::kReach;
}

}  // namespace

void bind_muscles_skin_mesh(py::module_& m) {
    bind_checks(m);
    bind_mesh(m);
    bind_jaw(m);
    bind_eyes(m);
}

}  // namespace mimetic::bindings
