// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/eyeballs.hpp>

#include "stacks.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

std::array<EyeAngles, 2> turns_of(const Eigen::Vector4d& degrees) {
    return {EyeAngles{degrees[0], degrees[1]}, EyeAngles{degrees[2], degrees[3]}};
}

}  // namespace

void bind_muscles_eyeballs(py::module_& m) {
    m.def(
        "turned_eyeballs",
        [](PointsIn vertices, const Eigen::VectorXi& eye_of, PointsIn centres,
           const Eigen::Vector4d& degrees) {
            return turned_eyeballs(vertices, eye_of, centres, turns_of(degrees));
        },
        "vertices"_a, "eye_of"_a, "centres"_a, "degrees"_a,
        "Vertices (V, 3) with the eyeballs turned rigidly, without torsion.\n\n"
        "eye_of: (V,) int32, 0 none, 1 left, 2 right; centres: (2, 3), left first, metres; degrees: (4,), "
        "yaw\nand pitch of the left, then of the right eye, positive to the subject's left and up. Raises "
        "InvalidInput.");
    m.def(
        "eye_turn_modes",
        [](PointsIn points, const Eigen::RowVector3d& centre) {
            return array_of_stack(eye_turn_modes(points, centre));
        },
        "points"_a, "centre"_a,
        "Displacements (5, K, 3) of an eyeball's points (K, 3), which `eye_turn_weights` add up to any rigid "
        "turn.");
    m.def("eye_turn_weights", &eye_turn_weights, "yaw"_a, "pitch"_a,
          "Weights (N, 5) of `eye_turn_modes` for N turns in degrees.");
    m.def(
        "iris_circle",
        [](const Eigen::Vector3d& centre, const Eigen::Vector3d& iris_centre, double yaw, double pitch,
           double radius,
           int count) { return iris_circle(centre, iris_centre, {yaw, pitch}, radius, count); },
        "centre"_a, "iris_centre"_a, "yaw"_a, "pitch"_a, "radius"_a, "count"_a,
        "(1 + count, 3): the middle of the iris of an eyeball that has turned by degrees, then its rim.\n\n"
        "iris_centre: before the turn; radius: of the iris, metres. Raises InvalidInput.");
    m.def(
        "gaze_direction", [](double yaw, double pitch) { return gaze_direction({yaw, pitch}); }, "yaw"_a,
        "pitch"_a, "Unit vector (3,) in the head frame; degrees.");
    m.def(
        "gaze_offsets", &gaze_offsets, "yaw"_a, "pitch"_a, "distance"_a,
        "Where eyes look on an upright plane at a distance, against straight ahead: (N, 2), to the subject's "
        "left\nand up, of N turns in degrees. Raises InvalidInput.");
    py::class_<LidFollowing>(m, "LidFollowing", "How an upper lid goes along as the eye looks up and down.")
        .def(py::init(
                 [](double per_degree, double rest_pitch) { return LidFollowing{per_degree, rest_pitch}; }),
             "per_degree"_a, "rest_pitch"_a)
        .def_readonly_static("HIGHEST_CARRIED", &LidFollowing::kHighestCarried)
        .def_readonly_static("LOWEST_CARRIED", &LidFollowing::kLowestCarried)
        .def_readonly("per_degree", &LidFollowing::per_degree)
        .def_readonly("rest_pitch", &LidFollowing::rest_pitch)
        .def("seen", &LidFollowing::seen, "own"_a, "pitch"_a,
             "Closure that is seen, (N,), of the lid's own at gazes (N,), degrees.")
        .def("own", &LidFollowing::own, "seen"_a, "pitch"_a, "The inverse of `seen`.");
    m.def("lid_following", &lid_following, "lids"_a,
          "Share of the opening by which the upper lid is lowered for each degree that the eye looks down.");
}

}  // namespace mimetic::bindings
