// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/extras.hpp>
#include <mimetic/muscles/response.hpp>
#include <mimetic/muscles/skin_modes.hpp>

#include "compressed_rows.hpp"
#include "stacks.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;
using MeshPointer = std::shared_ptr<SkinMesh>;

namespace {

void bind_placed_extras(py::module_& m) {
    py::enum_<ExtraType>(m, "ExtraType")
        .value("push", ExtraType::push)
        .value("roll", ExtraType::roll)
        .value("pressure", ExtraType::pressure);
    py::class_<ExtraEntry>(m, "ExtraEntry", "An entry of data/extras.toml that loads the skin.")
        .def(py::init([](std::string name, ExtraType type, bool paired, bool upper,
                         std::vector<LandmarkPlace> line, double forwards, double inwards, double width,
                         const LandmarkPlace& measured_at, double excursion) {
                 return ExtraEntry{std::move(name), type,    paired, upper,       std::move(line),
                                   forwards,        inwards, width,  measured_at, excursion};
             }),
             py::kw_only(), "name"_a, "type"_a, "paired"_a, "upper"_a, "line"_a, "forwards"_a, "inwards"_a,
             "width"_a, "measured_at"_a, "excursion"_a, "width, excursion: mm; upper: roll of the upper lip");
    py::class_<PlacedExtra>(m, "PlacedExtra", "An extra on a head.")
        .def_readonly("line", &PlacedExtra::line, "(K, 3) on the skin, metres")
        .def_readonly("measured", &PlacedExtra::measured, "Place whose motion sets its strength")
        .def(
            "carried",
            [](PlacedExtra placed, PointsIn line) {
                placed.line = line;
                return placed;
            },
            "line"_a, "The same with its line (K, 3) on another skin.");
    py::class_<MouthFrame>(m, "MouthFrame", "The mouth's position and size, for extras.")
        .def(py::init([](const MeshPointer& mesh) { return mouth_frame(*mesh); }), "mesh"_a)
        .def_readonly("slit", &MouthFrame::slit, "(3,), the middle between the lips")
        .def_readonly("size", &MouthFrame::size, "times as long as the template");
    m.def(
        "place_extras",
        [](const MeshPointer& canonical, const MeshPointer& mesh, const std::vector<ExtraEntry>& table) {
            return place_extras(*canonical, *mesh, table);
        },
        "canonical"_a, "mesh"_a, "table"_a, release_gil(),
        "Extras on a head of the template's mesh, left and right of a paired entry in turn.");
    m.def(
        "extra_responses",
        [](const AttachedSkin& skin, const MuscleSurface& surface, const MouthFrame& mouth,
           const std::vector<PlacedExtra>& extras, const CompressedRows& measured) {
            MatrixRows responses;
            {
                const py::gil_scoped_release release;
                responses = extra_responses(skin, surface, mouth, extras, measured.matrix);
            }
            return array_of_stack(std::move(responses));
        },
        "skin"_a, "surface"_a, "mouth"_a, "extras"_a, "measured"_a,
        "(E, S, 3) at value 1, each with the strength that gives its excursion.\n\n"
        "measured: CompressedRows (E, S) that read the motion of each measured place\n"
        "raises InvalidInput, naming it, on a place that does not move");
}

void bind_gaze(py::module_& m) {
    py::class_<Gaze>(m, "Gaze", "An eyeball that turns about its centre.")
        .def(py::init([](const Eigen::RowVector3d& axis, double angle) { return Gaze{axis, angle}; }),
             "axis"_a, "angle"_a, "axis: (3,) of the left eye, the right eye's is mirrored; angle: radians");
    m.def("turned_eye", &turned_eye, "frame"_a, "gaze"_a, "points"_a,
          "Displacement of points (K, 3) of an eyeball turned by its whole angle.");
    m.def("lid_angle", &lid_angle, "lids"_a, "gaze"_a, release_gil(),
          "How far the skin about an eye turns with the lids as the eye looks up or down, (S,) radians.");
}

void bind_response(py::module_& m) {
    m.def("stiffness_factors", &stiffness_factors, "weights"_a, "factors"_a,
          "(N,) times the attachment at every refined vertex.\n\n"
          "weights: (N, R), membership of each vertex in each region; factors: (R,)");
    py::class_<SkinResponse>(m, "SkinResponse",
                             "A person's muscles and jaw on the skin, for one calibration after another.")
        .def(py::init([](const MeshPointer& mesh, const MeshPointer& canonical,
                         const std::vector<MuscleEntry>& muscles, const MaterialTable& materials,
                         const MatrixRows& weights) {
                 return std::make_unique<SkinResponse>(mesh, canonical, muscles, materials, weights);
             }),
             "mesh"_a, "canonical"_a, "muscles"_a, "materials"_a, "weights"_a, release_gil(),
             "weights: (N, R), as for stiffness_factors")
        .def(
            "evaluate",
            [](const SkinResponse& response, const Eigen::VectorXd& stiffness,
               const Eigen::VectorXd& strength, const Points2& insertion_mm, const std::vector<int>& moved) {
                ResponsiveModes result;
                {
                    const py::gil_scoped_release release;
                    result = response.evaluate({stiffness, strength, insertion_mm}, moved);
                }
                return py::make_tuple(array_of_stack(std::move(result.modes)),
                                      array_of_stack(std::move(result.by_stiffness)),
                                      array_of_stack(std::move(result.by_insertion)));
            },
            "stiffness"_a, "strength"_a, "insertion_mm"_a, "moved"_a,
            "stiffness: (R,) factors; strength: (M,) factors; insertion_mm: (M, 2); moved: muscles to "
            "derive\n"
            "by their insertion\n"
            "returns: modes (Q, S, 3) of muscles, jaw and lids, (R Q, S, 3) by the logarithm of each "
            "region's\n"
            "factor, (2 Q, S, 3) by a millimetre of each insertion away from the midline, then up");
}

}  // namespace

void bind_muscles_extras(py::module_& m) {
    bind_placed_extras(m);
    bind_gaze(m);
    bind_response(m);
    m.def(
        "low_energy_modes",
        [](const AttachedSkin& skin, PointsIn weight, const Eigen::Ref<const Eigen::MatrixXd>& start,
           int count, double unit) {
            SkinModes skin_modes;
            {
                const py::gil_scoped_release release;
                skin_modes = low_energy_modes(skin, weight, start, count, unit);
            }
            return py::make_tuple(array_of_stack(std::move(skin_modes.modes)), skin_modes.compliance);
        },
        "skin"_a, "weight"_a, "start"_a, "count"_a, "unit"_a,
        "Modes (K, S, 3), metres, and their compliances (K,), falling.\n\n"
        "weight: (N, 3) of displacements, sums to 1; start: (3U, C > count), columns at random; unit: "
        "metres,\n"
        "root mean square at the coefficient 1");
}

}  // namespace mimetic::bindings
