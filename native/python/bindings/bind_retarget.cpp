// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/retarget/bounded_fit.hpp>
#include <mimetic/retarget/control_fit.hpp>
#include <mimetic/retarget/eye_channels.hpp>
#include <mimetic/retarget/response.hpp>
#include <mimetic/retarget/seen_areas.hpp>
#include <mimetic/retarget/touching_rims.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_eye_channels(py::module_& m) {
    m.def("eye_rates", &eye_rates, "turned"_a, "is_aim"_a, "step"_a,
          "Rotation vectors (2, 3) of both eyes at value 1 of a channel by which they turned so from value\n"
          "-step to step; is_aim: the eyes look at what moves, so that values are as the tangent.");
    m.def("gaze_turns", &gaze_turns, "yaw"_a, "pitch"_a,
          "(N, 3) rotation vectors of eyes that look ahead at rest, the shortest way; degrees (N,), in a\n"
          "frame with x to the subject's left, z up, the face towards -y.");
    py::class_<EyeChannels>(m, "EyeChannels", "Values of channels that turn eyes; see eye_channels.hpp.")
        .def(py::init([](const std::vector<int>& bones, const std::vector<bool>& are_aims,
                         const std::vector<EyeTurns>& turns, const Eigen::Vector3d& ahead,
                         const std::vector<int>& eyes) {
                 if (bones.size() != turns.size() || are_aims.size() != turns.size()) {
                     throw InvalidInput("each channel has a bone, a kind and turns");
                 }
                 std::vector<EyeChannel> channels;
                 for (std::size_t k = 0; k < bones.size(); ++k) {
                     channels.push_back({bones[k], are_aims[k], turns[k]});
                 }
                 return EyeChannels(std::move(channels), ahead, eyes);
             }),
             "bones"_a, "are_aims"_a, "turns"_a, "ahead"_a, "eyes"_a,
             "Of K channels: the bone that each is of, whether eyes look at it, and rotation vectors (2, 3) "
             "at\nvalue 1; ahead: (3,), where eyes look at rest; eyes: which there are, 0 (left) and 1. "
             "Raises InvalidInput.")
        .def("values", &EyeChannels::values, "turns"_a,
             "(T, K) for rotation vectors of both eyes (T, 6). Raises InvalidInput.")
        .def("undriven", &EyeChannels::undriven, "Eyes that no channel turns.");
}

}  // namespace

void bind_retarget(py::module_& m) {
    bind_eye_channels(m);
    m.def("polygon_areas", &polygon_areas, "points"_a, "starts"_a, "corners"_a,
          "A share of each polygon's area for the vertices (V,) of its corners, square units of points\n"
          "(V, 3). starts: the first corner of each polygon; corners: vertices. Raises InvalidInput.");
    m.def("seen_areas", &seen_areas, "points"_a, "starts"_a, "corners"_a,
          py::call_guard<py::gil_scoped_release>(),
          "The same, and a hundredth of it of what cannot be seen from outside; see seen_areas.hpp.");
    py::class_<TiedVertices>(m, "TiedVertices",
                             "Pairs of vertices that shall lie to each other as sources have them.")
        .def(py::init<>())
        .def_readonly("pairs", &TiedVertices::pairs, "(P, 2) vertices.")
        .def_readonly("ways", &TiedVertices::ways, "(P, 3): unit vectors along which they part.")
        .def_readonly("weights", &TiedVertices::weights, "(P,)");
    m.def(
        "touching_rims",
        [](PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners, VectorIn areas,
           PointsIn offsets, bool shuts) {
            return touching_rims(points, starts, corners, areas, offsets,
                                 shuts ? RimMotion::shuts : RimMotion::parts);
        },
        "points"_a, "starts"_a, "corners"_a, "areas"_a, "offsets"_a, "shuts"_a,
        py::call_guard<py::gil_scoped_release>(),
        "TiedVertices of two rims that touch, at rest or where a source that shuts them leaves them; see\n"
        "touching_rims.hpp. points, offsets: (V, 3); areas: (V,). Raises InvalidInput.");
    m.def("joined", &joined, "parts"_a, "Several TiedVertices as one.");
    m.def(
        "played_values",
        [](const Eigen::VectorXd& fitted, double gain, double offset, double lowest, double highest,
           double curve) { return played_values(fitted, {gain, offset, lowest, highest, curve}); },
        "fitted"_a, "gain"_a, "offset"_a, "lowest"_a, "highest"_a, "curve"_a,
        "Fitted values (N,) of a control as they are played; see response.hpp. Raises InvalidInput.");
    py::class_<ControlFitOptions>(m, "ControlFitOptions", "See control_fit.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("sparsity", &ControlFitOptions::sparsity)
        .def_readwrite("ridge", &ControlFitOptions::ridge)
        .def_readwrite("unmatched_motion", &ControlFitOptions::unmatched_motion)
        .def_readwrite("least_explained", &ControlFitOptions::least_explained)
        .def_readwrite("value_match", &ControlFitOptions::value_match)
        .def_readwrite("tied_reading", &ControlFitOptions::tied_reading)
        .def_readwrite("hold_shut", &ControlFitOptions::hold_shut)
        .def_readwrite("hold_slack", &ControlFitOptions::hold_slack);
    py::class_<ControlFit>(m, "ControlFit",
                           "Values of sources as values of a character's own controls; see "
                           "control_fit.hpp.")
        .def(
            py::init([](const ModesArray& controls, const ModesArray& sources, const Eigen::VectorXd& weights,
                        const MatrixRows& control_range, const MatrixRows& source_range,
                        const ControlFitOptions& options, const TiedVertices& tied) {
                const auto own = view_modes("controls", controls, weights.size());
                const auto other = view_modes("sources", sources, weights.size());
                py::gil_scoped_release release;
                return ControlFit(own, other, weights, control_range, source_range, options, tied);
            }),
            "controls"_a, "sources"_a, "weights"_a, "control_range"_a, "source_range"_a,
            "options"_a = ControlFitOptions(), "tied"_a = TiedVertices(),
            "controls: (K, V, 3), sources: (S, V, 3), at value 1; weights: (V,); ranges: (K, 2), (S, 2), "
            "around 0.\nRaises InvalidInput.")
        .def_property_readonly("readings", &ControlFit::readings,
                               "(K, S): values of sources that do what each control does.")
        .def_property_readonly("readable", &ControlFit::readable,
                               "(K,): the share of its motion that they make, 0 to 1.")
        .def("frames", &ControlFit::frames, "values"_a, "expected"_a,
             py::call_guard<py::gil_scoped_release>(),
             "(T, K): the best values of the controls for values (T, S), pulled to expected (T, K).")
        .def("mapping", &ControlFit::mapping, py::call_guard<py::gil_scoped_release>(),
             "(2 S, K): each source at its highest and at its lowest, as values of the controls.")
        .def("explained", &ControlFit::explained, "values"_a, "fitted"_a,
             "The share of the motion of all rows (T, S) that fitted values (T, K) make.")
        .def("source_explained", &ControlFit::source_explained, py::call_guard<py::gil_scoped_release>(),
             "(S,): the share of each source's motion that its row of the mapping makes at its best size.");
}

}  // namespace mimetic::bindings
