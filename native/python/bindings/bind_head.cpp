// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/head/head.hpp>
#include <mimetic/head/placing.hpp>
#include <mimetic/head/pose_smoothing.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_shape(py::module_& m) {
    py::enum_<HeadModel>(m, "HeadModel", "The rigid body that stands for the head.")
        .value("ellipsoid", HeadModel::ellipsoid, "the paper's")
        .value("plane", HeadModel::plane, "the patch that the paper compares with")
        .value("surface", HeadModel::surface, "the person's own surface");
    py::class_<MovingPart>(m, "MovingPart", "A non-rigid part of the face, which is weighted down.")
        .def(
            py::init([](const Eigen::Vector2d& centre, double radius, double share) {
                return MovingPart{centre, radius, share};
            }),
            "centre"_a, "radius"_a = MovingPart{}.radius, "share"_a = MovingPart{}.share,
            "centre: (x, y) in the head frame, metres; radius: metres; share: taken from the weight, 0 to 1");
    py::class_<HeadShape>(m, "HeadShape", "The model of a head; head frame, metres.")
        .def_readonly("model", &HeadShape::model)
        .def_readonly("centre", &HeadShape::centre, "(3,)")
        .def_readonly("half_axes", &HeadShape::half_axes, "(3,) along x, y, z")
        .def_readonly("turn", &HeadShape::turn, "(3, 3) its axes, columns, in the head frame; ellipsoid")
        .def_readonly("depth_error", &HeadShape::depth_error, "s.d. of the head about the model, metres")
        .def_readwrite("moving_parts", &HeadShape::moving_parts);
    m.def("make_head_shape", &make_head_shape, "model"_a, py::arg("vertices").noconvert(),
          py::arg("faces").noconvert(), py::call_guard<py::gil_scoped_release>(),
          "The model nearest to a head's skin.\n\nvertices: (V, 3) float64, metres; faces: (F, 4) int32 of "
          "the skin that\nis seen. Raises InvalidInput.");
    py::class_<HeadOptions>(m, "HeadOptions", "How a head is tracked; see head.hpp for units.")
        .def(py::init<>())
        .def_readwrite("crop_height", &HeadOptions::crop_height)
        .def_readwrite("sample_spacing", &HeadOptions::sample_spacing)
        .def_readwrite("max_iterations", &HeadOptions::max_iterations)
        .def_readwrite("max_key_views", &HeadOptions::max_key_views)
        .def_readwrite("key_view_angle", &HeadOptions::key_view_angle)
        .def_readwrite("least_facing", &HeadOptions::least_facing)
        .def_readwrite("held_quality", &HeadOptions::held_quality)
        .def_readwrite("flow_method", &HeadOptions::flow_method)
        .def_readwrite("frame_rate", &HeadOptions::frame_rate)
        .def_readwrite("fast", &HeadOptions::fast);
}

void bind_tracker(py::module_& m) {
    py::class_<PlacedView>(m, "PlacedView", "Pose of a reference texture by each of two models.")
        .def(py::init([](const Eigen::Matrix4d& on_model, const Eigen::Matrix4d& on_skin) {
                 return PlacedView{to_isometry(on_model), to_isometry(on_skin)};
             }),
             "on_model"_a, "on_skin"_a, "(4, 4) each, camera from head, metres")
        .def_property_readonly(
            "on_model", [](const PlacedView& v) { return v.on_model.matrix(); }, "(4, 4), metres")
        .def_property_readonly(
            "on_skin", [](const PlacedView& v) { return v.on_skin.matrix(); }, "(4, 4), metres");
    py::class_<HeadEstimate>(m, "HeadEstimate", "Pose of one frame with its covariance.")
        .def_property_readonly(
            "camera_from_head", [](const HeadEstimate& e) { return e.camera_from_head.matrix(); },
            "(4, 4), metres")
        .def_readonly("covariance", &HeadEstimate::covariance,
                      "(6, 6) of (rotation vector, translation): exp(r) R, t + d; rad, metres")
        .def_readonly("quality", &HeadEstimate::quality, "0 lost to 1 well explained")
        .def_readonly("held", &HeadEstimate::held, "nothing was measured: repeats the last good pose")
        .def_readonly("found_again", &HeadEstimate::found_again,
                      "from search or a guess, not tracked: it may be another head")
        .def_readonly("likeness", &HeadEstimate::likeness,
                      "share of the visible skin that matches a reference texture")
        .def_readonly("num_samples", &HeadEstimate::num_samples)
        .def_readonly("explained", &HeadEstimate::explained)
        .def_readonly("residual_px", &HeadEstimate::residual_px)
        .def_readonly("correlation", &HeadEstimate::correlation)
        .def_readonly("num_views", &HeadEstimate::num_views);
    py::class_<HeadTracker>(m, "HeadTracker", "Tracks a rigid head in 6 degrees of freedom.")
        .def(py::init([](const Camera& camera, const HeadShape& shape, const ImageArray& image,
                         const Eigen::Matrix4d& camera_from_head, const HeadOptions& options) {
                 const ColorView view = view_image<3>(image, "the reference image");
                 const py::gil_scoped_release unlocked;
                 return HeadTracker(camera, shape, view, to_isometry(camera_from_head), options);
             }),
             "camera"_a, "shape"_a, py::arg("image").noconvert(), "camera_from_head"_a,
             "options"_a = HeadOptions{},
             "image: (H, W, 3) uint8, where the head is at camera_from_head (4, 4). Raises InvalidInput.")
        .def(
            "advance",
            [](HeadTracker& tracker, const ImageArray& image, const std::optional<Eigen::Matrix4d>& guess) {
                const ColorView view = view_image<3>(image, "the frame");
                const auto pose = guess ? std::optional(to_isometry(*guess)) : std::nullopt;
                const py::gil_scoped_release unlocked;
                return tracker.advance(view, pose);
            },
            py::arg("image").noconvert(), "guess"_a = py::none(),
            "HeadEstimate of the next frame.\n\nimage: (H, W, 3) uint8; guess: (4, 4) where a detector sees "
            "the head,\ntried when it was lost.")
        .def("forget", &HeadTracker::forget, "num_last"_a, py::call_guard<py::gil_scoped_release>(),
             "Drops the reference textures of the last frames: these show something else.")
        .def(
            "restart",
            [](HeadTracker& tracker, const ImageArray& image, const HeadEstimate& estimate) {
                tracker.restart(view_image<3>(image, "the frame"), estimate);
            },
            py::arg("image").noconvert(), "estimate"_a,
            "Goes back to a frame, to track the clip in the other direction; reference textures are kept.")
        .def("relax", &HeadTracker::relax, py::call_guard<py::gil_scoped_release>(),
             "Solves for the poses of the reference textures and the shape anew, from all of them: a clip "
             "followed\n"
             "once more after it is followed better. False: no two of them show the same skin.")
        .def(
            "place_on", &HeadTracker::place_on, "skin"_a, py::call_guard<py::gil_scoped_release>(),
            "PlacedView of each reference texture: where it is by the model, and on a HeadShape that is the\n"
            "head's own surface. Empty: no two of them show the same skin.")
        .def(
            "move_views",
            [](HeadTracker& tracker, const DoubleArray& poses) {
                tracker.move_views(poses_of(poses, "poses"));
            },
            "poses"_a,
            "Moves the reference textures, in their order, to poses (N, 4, 4) and shapes the model so that "
            "it\n"
            "agrees. Raises InvalidInput.")
        .def_property_readonly("shape", &HeadTracker::shape,
                               "HeadShape estimated from all reference textures.");
}

void bind_motion(py::module_& m) {
    m.def(
        "smooth_poses",
        [](const DoubleArray& poses, const DoubleArray& covariances, const Eigen::VectorXd& seconds,
           const std::vector<bool>& measured, double strength) {
            PoseSequence motion{poses_of(poses, "poses"), matrices_of<6, 6>(covariances, "covariances")};
            {
                const py::gil_scoped_release unlocked;
                motion = smooth_poses(motion, seconds, measured, strength);
            }
            return py::make_tuple(array_of(motion.poses), array_of<6, 6>(motion.covariances));
        },
        "poses"_a, "covariances"_a, "seconds"_a, "measured"_a, "strength"_a,
        "Rigid motion smoothed forward and backward, without lag: (N, 4, 4), (N, 6, 6).\n\n"
        "poses: (N, 4, 4), metres; covariances: (N, 6, 6) of (rotation vector, translation):\nexp(d) R, t + "
        "d; seconds: (N,), rising; measured: N, false where a pose is held;\nstrength: what standard "
        "deviations are multiplied by, 0 changes nothing. Raises InvalidInput.");
    m.def(
        "place_poses",
        [](const DoubleArray& poses, const std::vector<PlacedView>& views) {
            return array_of(place_poses(poses_of(poses, "poses"), views));
        },
        "poses"_a, "views"_a,
        "(N, 4, 4): poses by a simple model (N, 4, 4), corrected to the person's own surface.");
}

}  // namespace

void bind_head(py::module_& m) {
    bind_shape(m);
    bind_tracker(m);
    bind_motion(m);
}

}  // namespace mimetic::bindings
