// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/surface/centre_of_motion.hpp>
#include <mimetic/surface/edge_loop.hpp>
#include <mimetic/surface/nearest.hpp>
#include <mimetic/surface/places.hpp>
#include <mimetic/surface/shown_places.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <mimetic/surface/surface.hpp>
#include <mimetic/surface/ways.hpp>

#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

/// (on_face, triangle, weights, offset), or None.
py::object places_under_pixels(const Camera& camera, PointsIn vertices, QuadsIn faces, Points2In pixels) {
    std::optional<SurfacePlaces> places;
    {
        const py::gil_scoped_release release;
        places = places_under(camera, vertices, faces, pixels);
    }
    if (!places) {
        return py::none();
    }
    py::array_t<bool> on_face(static_cast<py::ssize_t>(places->on_face.size()));
    std::copy(places->on_face.begin(), places->on_face.end(), on_face.mutable_data());
    return py::make_tuple(on_face, places->triangle, places->weights, places->offset);
}

void bind_skin_places(py::module_& m) {
    py::class_<SkinPlaces>(m, "SkinPlaces", "P points on the triangles of a surface of N vertices.")
        .def(py::init([](const Triangles& corners, const Points& weights) {
                 if (corners.rows() != weights.rows() || (corners.size() > 0 && corners.minCoeff() < 0)) {
                     throw InvalidInput("a place needs three corners, and their weights");
                 }
                 return SkinPlaces{corners, weights, Eigen::VectorXd::Zero(corners.rows())};
             }),
             "corners"_a, "weights"_a)
        .def_readonly("corners", &SkinPlaces::corners, "(P, 3), vertices")
        .def_readonly("weights", &SkinPlaces::weights, "(P, 3), of the corners; they sum to 1")
        .def_readonly("gaps", &SkinPlaces::gaps, "(P,), metres from the query points")
        .def(
            "values",
            [](const SkinPlaces& self, const DoubleArray& at_vertices) -> DoubleArray {
                const bool is_flat = at_vertices.ndim() == 1;
                if (!is_flat && at_vertices.ndim() != 2) {
                    throw InvalidInput("values at vertices must have the shape (N,) or (N, K)");
                }
                const py::ssize_t columns = is_flat ? 1 : at_vertices.shape(1);
                const MatrixRows values = self.values(
                    Eigen::Map<const MatrixRows>(at_vertices.data(), at_vertices.shape(0), columns));
                std::vector<py::ssize_t> shape{values.rows()};
                if (!is_flat) {
                    shape.push_back(columns);
                }
                return DoubleArray(shape, values.data());
            },
            "at_vertices"_a, "Values at the vertices, (N,) or (N, K), interpolated: (P,) or (P, K).")
        .def("positions", &SkinPlaces::positions, "vertices"_a, "lift"_a = 0.,
             "(P, 3) on a shape of the surface (N, 3), metres, lifted off it outwards by so many metres.");
    m.def(
        "show_places",
        [](const Camera& camera, PointsIn vertices, QuadsIn faces, const SkinPlaces& places) {
            ShownPlaces shown;
            {
                const py::gil_scoped_release release;
                shown = show_places(camera, vertices, faces, places);
            }
            py::array_t<bool> visible(static_cast<py::ssize_t>(shown.visible.size()));
            std::copy(shown.visible.begin(), shown.visible.end(), visible.mutable_data());
            return py::make_tuple(std::move(shown.points), std::move(shown.pixels), std::move(visible));
        },
        "camera"_a, py::arg("vertices_in_camera").noconvert(), py::arg("faces").noconvert(), "places"_a,
        "Where places are: points (P, 3), metres, camera frame; pixels (P, 2), nan behind the camera; and "
        "which\nare in the picture, facing the camera and not occluded (P,).\n\n"
        "vertices_in_camera: (V, 3) float64, metres; faces: (F, 4) int32");
    m.def("nearest_places", &nearest_places, "points"_a, "vertices"_a, "triangles"_a, release_gil(),
          "SkinPlaces nearest to points (P, 3) on triangles (T, 3) of vertices (N, 3).");
    m.def(
        "nearest", [](PointsIn points, PointsIn among) { return NearestPoints(among).find(points); },
        "points"_a, "among"_a, release_gil(),
        "(P,) row of the nearest of `among` (N, 3) to each point (P, 3).");
}

}  // namespace

void bind_surface(py::module_& m) {
    m.def("edge_loop", &edge_loop, py::arg("faces").noconvert(), "start"_a, "over"_a,
          "Vertices met by going straight on over a mesh of quads, from a vertex over a neighbour.\n\n"
          "faces: (F, 4) int32; ends where not four faces meet. Raises InvalidInput.");
    bind_skin_places(m);
    m.def(
        "places_under", &places_under_pixels, "camera"_a, py::arg("vertices_in_camera").noconvert(),
        py::arg("faces").noconvert(), py::arg("pixels").noconvert(),
        "The place on a fitted head's surface that each pixel (K, 2) shows; None if no skin faces the "
        "camera.\n\n"
        "vertices_in_camera: (V, 3) float64, metres, of facets of a millimetre or two; faces: (F, 4) int32\n"
        "returns: on_face (K,) bool, pixels off it get the nearest skin; triangle (K,) "
        "of\n"
        "triangles_of; weights (K, 3) of its corners; offset (K, 2), pixels from the place to the pixel, 0 "
        "but\nat "
        "outlines. Raises InvalidInput.");
    m.def("shortest_way", &shortest_way, "quads"_a, "vertices"_a, "stops"_a, release_gil(),
          "Vertices of the shortest path along the edges of quads (F, 4) through some vertices in turn, ends "
          "included.\n\nvertices: (V, 3). Raises InvalidInput.");
    m.def(
        "nearest_sphere",
        [](const Points& points) {
            const Sphere sphere = nearest_sphere(points);
            return std::pair(sphere.centre, sphere.radius);
        },
        "points"_a,
        "(centre (3,), radius) of the sphere nearest to points (N, 3), metres. Raises InvalidInput.");
    m.def("triangles_of", &triangles_of, py::arg("quads").noconvert(),
          "(2 F, 3) int32: the halves (0, 1, 2) of all quads (F, 4), then the halves (0, 2, 3).");
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
            "stencils", [](const LimitSurface& self) { return CompressedRows{self.position_stencils()}; },
            "CompressedRows of the P x V matrix of positions.")
        .def(
            "tangent_stencils",
            [](const LimitSurface& self) {
                return py::make_tuple(CompressedRows{self.s_tangent_stencils()},
                                      CompressedRows{self.t_tangent_stencils()});
            },
            "The same for d position / d s and d position / d t.");

    m.def("centre_of_motion", &centre_of_motion, "points"_a, "displacements"_a,
          "The middle (3,) of what displacements (V, 3) of points (V, 3) move, by their squares. Raises "
          "InvalidInput.");
    py::class_<SubdividedMesh>(
        m, "SubdividedMesh",
        "A quad mesh refined `levels` times, its vertices on the limit surface; refined "
        "vertex i < num_vertices is the limit of control vertex i.")
        .def(py::init<QuadsIn, int, int>(), py::arg("faces").noconvert(), "num_vertices"_a, "levels"_a,
             release_gil(), "faces: (F, 4) int32\nlevels: 0 to 5\nraises InvalidInput")
        .def_property_readonly("num_refined", &SubdividedMesh::num_refined)
        .def_property_readonly("faces", &SubdividedMesh::faces, "(F * 4^levels, 4) int32")
        .def_property_readonly("parent_face", &SubdividedMesh::parent_face, "(F * 4^levels,) int32")
        .def(
            "place_of",
            [](const SubdividedMesh& mesh, int triangle, const Eigen::Vector3d& weights) {
                const SubdividedMesh::FacePlace place = mesh.place_of(triangle, weights);
                return py::make_tuple(place.face, place.st);
            },
            "triangle"_a, "weights"_a,
            "The face of the control mesh and (s, t) there, (2,), of a point of a triangle of "
            "triangles_of(faces), by the\nweights (3,) of its corners. Raises InvalidInput.")
        .def("positions", &SubdividedMesh::positions, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (num_refined, 3)")
        .def("normals", &SubdividedMesh::normals, py::arg("vertices").noconvert(), release_gil(),
             "vertices: (V, 3) float64\nreturns: (num_refined, 3), unit, outwards")
        .def(
            "stencils", [](const SubdividedMesh& self) { return CompressedRows{self.stencils()}; },
            "CompressedRows of the num_refined x V matrix.");
}

}  // namespace mimetic::bindings
