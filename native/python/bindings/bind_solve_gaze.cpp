// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/solve/gaze.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

Eyeballs make_eyeballs(PointsIn centres, const Eigen::Vector2d& radii, PointsIn facing) {
    if (centres.rows() != 2 || facing.rows() != 2) {
        throw InvalidInput("eyeballs need two centres and two ways to face, the left first");
    }
    Eyeballs eyes;
    for (Eigen::Index eye = 0; eye < 2; ++eye) {
        const auto at = static_cast<std::size_t>(eye);
        eyes.centres[at] = centres.row(eye).transpose();
        eyes.radii[at] = radii[eye];
        eyes.facing[at] = facing.row(eye).transpose();
    }
    eyes.check();
    return eyes;
}

void set_irises(GazeFrame& frame, const Eigen::Matrix<double, 2, 6>& irises) {
    for (int eye = 0; eye < 2; ++eye) {
        const auto row = irises.row(eye);
        frame.irises[static_cast<std::size_t>(eye)] = {row.head<2>().transpose(), row[2], row[3], row[4],
                                                       row[5]};
    }
}

std::vector<GazeFrame> frames_of(const DoubleArray& poses, const DoubleArray& covariances,
                                 const DoubleArray& irises) {
    const auto matrices = matrices_of<4, 4>(poses, "poses");
    const auto spreads = matrices_of<6, 6>(covariances, "pose_covariances");
    const auto rows = matrices_of<2, 6>(irises, "irises");
    if (spreads.size() != matrices.size() || rows.size() != matrices.size()) {
        throw InvalidInput("poses, pose_covariances and irises need the same number of frames");
    }
    std::vector<GazeFrame> frames;
    for (std::size_t t = 0; t < matrices.size(); ++t) {
        GazeFrame& frame = frames.emplace_back();
        frame.camera_from_head = to_isometry(matrices[t]);
        frame.pose_cov = spreads[t];
        set_irises(frame, rows[t]);
    }
    return frames;
}

}  // namespace

void bind_solve_gaze(py::module_& m) {
    py::class_<Eyeballs>(m, "Eyeballs", "The eyeballs of a fitted head, left first; head frame, metres.")
        .def(py::init(&make_eyeballs), "centres"_a, "radii"_a, "facing"_a,
             "centres: (2, 3); radii: (2,), to the front of the iris; facing: (2, 3), the openings'. Raises\n"
             "InvalidInput.");
    py::class_<GazeTrack>(m, "GazeTrack",
                          "A clip's gaze, degrees: yaw and pitch of the left, then of the right eye.")
        .def_readonly("angles", &GazeTrack::angles, "(N, 4)")
        .def_readonly("std", &GazeTrack::std, "(N, 4)")
        .def_property_readonly(
            "rest",
            [](const GazeTrack& track) {
                return Eigen::Vector4d(track.rest[0].yaw, track.rest[0].pitch, track.rest[1].yaw,
                                       track.rest[1].pitch);
            },
            "(4,): how the eyes stand on this head at gaze 0")
        .def_readonly("rest_std", &GazeTrack::rest_std, "(4,)");
    m.def(
        "follow_gaze",
        [](const Camera& camera, const Eyeballs& eyes, const DoubleArray& poses,
           const DoubleArray& covariances, const DoubleArray& irises, double fps,
           const std::vector<int>& scene_starts) {
            const std::vector<GazeFrame> frames = frames_of(poses, covariances, irises);
            const py::gil_scoped_release unlocked;
            return follow_gaze(camera, eyes, frames, fps, scene_starts);
        },
        "camera"_a, "eyes"_a, "poses"_a, "pose_covariances"_a, "irises"_a, "fps"_a,
        "scene_starts"_a = std::vector<int>(),
        "GazeTrack of a clip's frames in order.\n\n"
        "poses: (N, 4, 4), camera from head; pose_covariances: (N, 6, 6); irises: (N, 2, 6), "
        "`FrameEstimate.irises`,\nof frames that are held 0; scene_starts: indices of frames after a cut, "
        "over which nothing is smoothed.\nRaises InvalidInput.");
    m.def(
        "corrected_gaze",
        [](const MatrixRows& angles, const std::vector<std::tuple<int, int, double, double, double>>& pins) {
            std::vector<GazePin> read;
            for (const auto& [index, angle, value, std, reach] : pins) {
                read.push_back({index, angle, value, std, reach});
            }
            return corrected_gaze(angles, read);
        },
        "angles"_a, "pins"_a,
        "(N, 4) degrees, as `GazeTrack.angles`, with what a person states of some frames.\n\n"
        "pins: (frame from 0, angle from 0, degrees, standard deviation in degrees, reach in frames) each.\n"
        "Both eyes follow a pin of one, save for vergence. Raises InvalidInput.");
    py::class_<GazeFilter>(m, "GazeFilter", "Gaze forward in time alone, for live use.")
        .def(py::init<const Eyeballs&>(), "eyes"_a)
        .def(
            "advance",
            [](GazeFilter& filter, const Camera& camera, const Eigen::Matrix4d& pose,
               const Matrix6& pose_covariance, const Eigen::Matrix<double, 2, 6>& irises, double seconds) {
                GazeFrame frame{to_isometry(pose), pose_covariance, {}};
                set_irises(frame, irises);
                return filter.advance(camera, frame, seconds);
            },
            "camera"_a, "pose"_a, "pose_covariance"_a, "irises"_a, "seconds"_a,
            "(4,) degrees: yaw and pitch of the left, then of the right eye, in the next frame.\n\n"
            "pose: (4, 4), pose_covariance: (6, 6), irises: (2, 6), as `follow_gaze` has them of a frame; "
            "seconds: since\nthe frame before.");
}

}  // namespace mimetic::bindings
