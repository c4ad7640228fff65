// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/solve/solve.hpp>
#include <variant>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

FaceMotion make_motion(Points neutral, const ModesArray& modes, int num_muscles, Eigen::VectorXd lower,
                       Eigen::VectorXd upper, Eigen::VectorXd prior_std,
                       const std::optional<ModesArray>& detail_modes,
                       std::optional<Eigen::VectorXd> detail_std, std::optional<Eigen::VectorXd> quickness,
                       std::optional<Eigen::VectorXd> depth_std, std::optional<Eigen::MatrixXd> correlation) {
    const Eigen::Index num_vertices = neutral.rows();
    FaceMotion motion{std::move(neutral),
                      {},
                      num_muscles,
                      std::move(lower),
                      std::move(upper),
                      std::move(prior_std),
                      MatrixRows(0, 3 * num_vertices),
                      detail_std.value_or(Eigen::VectorXd()),
                      quickness.value_or(Eigen::VectorXd()),
                      depth_std.value_or(Eigen::VectorXd()),
                      correlation.value_or(Eigen::MatrixXd())};
    motion.modes = view_modes("modes", modes, num_vertices);
    if (detail_modes) {
        motion.detail_modes = view_modes("detail_modes", *detail_modes, num_vertices);
    }
    return motion;
}

void bind_options(py::module_& m) {
    py::class_<TrackerOptions>(m, "TrackerOptions", "How a face is tracked; the defaults suit webcams.")
        .def(py::init<>())
        .def_readwrite("crop_height", &TrackerOptions::crop_height,
                       "pixels of the face in the reference texture")
        .def_readwrite("sample_spacing", &TrackerOptions::sample_spacing, "reference pixels between samples")
        .def_readwrite("max_iterations", &TrackerOptions::max_iterations)
        .def_readwrite("max_key_views", &TrackerOptions::max_key_views)
        .def_readwrite("model_error", &TrackerOptions::model_error, "metres")
        .def_readwrite("shape_error", &TrackerOptions::shape_error, "metres")
        .def_readwrite("correlation_time", &TrackerOptions::correlation_time, "frames")
        .def_readwrite("held_quality", &TrackerOptions::held_quality, "below it a frame is held, 0 to 1")
        .def_readwrite("relative_flow", &TrackerOptions::relative_flow)
        .def_readwrite("flow_method", &TrackerOptions::flow_method);
    py::class_<SmootherOptions>(m, "SmootherOptions", "How smooth a clip's states are, standard deviations.")
        .def(py::init<>())
        .def_readwrite("frame_rate", &SmootherOptions::frame_rate,
                       "of the clip; accelerations are those of clips of 24 to 30 frames a second")
        .def_readwrite("value_acceleration", &SmootherOptions::value_acceleration, "1 a frame squared")
        .def_readwrite("rotation_acceleration", &SmootherOptions::rotation_acceleration,
                       "rad a frame squared")
        .def_readwrite("translation_acceleration", &SmootherOptions::translation_acceleration,
                       "metres a frame squared")
        .def_readwrite("max_iterations", &SmootherOptions::max_iterations)
        .def_readwrite("muscle_headroom", &SmootherOptions::muscle_headroom,
                       "times their upper bounds that muscles may reach which stand at them")
        .def_readwrite("first_muscle_bound", &SmootherOptions::first_muscle_bound,
                       "upper bound of muscles whose own is higher, until they stand at it")
        .def_readwrite("fixed_first", &SmootherOptions::fixed_first,
                       "frames at the start whose states stay as they are")
        .def_readwrite("fixed_last", &SmootherOptions::fixed_last, "the same at the end");
}

void bind_model(py::module_& m) {
    py::class_<FaceMotion>(m, "FaceMotion", "How a face moves: neutral + sum of values_j modes_j, metres.")
        .def(
            py::init(&make_motion), "neutral"_a, py::arg("modes").noconvert(), "num_muscles"_a, "lower"_a,
            "upper"_a, "prior_std"_a, py::arg("detail_modes").noconvert() = py::none(),
            "detail_std"_a = py::none(), "quickness"_a = py::none(), "depth_std"_a = py::none(),
            "correlation"_a = py::none(),
            "neutral: (V, 3); modes: (M, V, 3) float64, displacement at the value 1, muscles first; lower,\n"
            "upper, prior_std: (M,), s.d. of a value about 0. detail_modes: (D, V, 3), for what the values\n"
            "cannot explain; detail_std: (D,). quickness: (M,), speed of a value relative to a skin muscle.\n"
            "depth_std: (M,), s.d. of the depth of the skin that a value moves along x, in units of the\n"
            "value, 0 for others. correlation: (M, M) of the values about 0; without it every value goes\n"
            "alone. Raises InvalidInput.")
        .def_readonly("num_muscles", &FaceMotion::num_muscles)
        .def_readonly("lower", &FaceMotion::lower)
        .def_readonly("upper", &FaceMotion::upper);
    py::class_<FeatureOpening>(m, "FeatureOpening",
                               "An eye or the mouth: lines on the skin from corner to corner.")
        .def(py::init([](std::vector<std::vector<int>> lines, const Eigen::Vector3d& facing,
                         std::vector<int> shutting, int lid_upper, int lid_lower, int jaw) {
                 return FeatureOpening{std::move(lines),    lid_upper, lid_lower,
                                       std::move(shutting), jaw,       facing};
             }),
             "lines"_a, "facing"_a, "shutting"_a, "lid_upper"_a = -1, "lid_lower"_a = -1, "jaw"_a = -1,
             "lines: vertices, of an eye the upper and the lower margin; facing: (3,) head frame; shutting: "
             "indices\n"
             "among the values by which it shuts, free in the reference frame; lid_upper,\n"
             "lid_lower: indices among the values, -1: no eye; jaw: that of what parts lips by bone.");
    py::class_<FeatureInputs>(m, "FeatureInputs", "Where eyes and mouth are on the head, and their source.")
        .def(py::init<>())
        .def(py::init([](std::vector<FeatureOpening> openings,
                         const std::variant<const FeatureNetworks*, const EyeRegressor*>& source,
                         const Camera& camera, const Points& anchors, const OcclusionNetwork& occlusion,
                         const std::optional<StillCover>& still_cover) {
                 FeatureInputs inputs{std::move(openings), {}};
                 inputs.occlusion = see_occlusion(occlusion, camera);
                 inputs.still_cover = still_cover.value_or(StillCover{});
                 if (const auto* networks = std::get_if<const FeatureNetworks*>(&source)) {
                     inputs.source = see_by_networks(**networks, camera, anchors);
                 } else {
                     inputs.source =
                         see_by_regressor(*std::get<const EyeRegressor*>(source), camera, anchors);
                 }
                 return inputs;
             }),
             "openings"_a, py::arg("source").none(false), "camera"_a, "anchors"_a, "occlusion"_a,
             "still_cover"_a = py::none(), py::keep_alive<1, 3>(), py::keep_alive<1, 6>(),
             "openings: left eye, right eye, mouth; source: FeatureNetworks, or EyeRegressor for the eyes\n"
             "alone; anchors: (6, 3), as feature_crops has them; occlusion: an OcclusionNetwork, without "
             "which\n"
             "nothing is taken to be before the face; still_cover: StillCover, what stands still in the "
             "picture\n"
             "in all frames, or None.");
    py::class_<StageTimes>(m, "StageTimes", "Milliseconds of one frame's stages.")
        .def_readonly("predict_ms", &StageTimes::predict_ms)
        .def_readonly("features_ms", &StageTimes::features_ms)
        .def_readonly("warp_ms", &StageTimes::warp_ms)
        .def_readonly("flow_ms", &StageTimes::flow_ms)
        .def_readonly("solve_ms", &StageTimes::solve_ms)
        .def_readonly("total_ms", &StageTimes::total_ms);
}

void bind_estimate(py::module_& m) {
    py::class_<FrameEstimate>(m, "FrameEstimate", "Pose and values of one frame with their covariance.")
        .def_property_readonly(
            "camera_from_head", [](const FrameEstimate& e) { return e.camera_from_head.matrix(); },
            "(4, 4), metres")
        .def_property_readonly("pose_cov", &FrameEstimate::pose_cov,
                               "(6, 6) of (rotation vector, translation): exp(r) R, t + d; rad, metres")
        .def_readonly("values", &FrameEstimate::values, "(M,)")
        .def_property_readonly("values_std", &FrameEstimate::values_std, "(M,), model error included")
        .def_readonly("covariance", &FrameEstimate::covariance, "(6 + M, 6 + M), pose first")
        .def_property_readonly(
            "detail", [](const FrameEstimate& e) { return e.detail.coefficients; },
            "(D,) of the detail modes")
        .def_property_readonly(
            "detail_std", [](const FrameEstimate& e) { return e.detail.std; }, "(D,)")
        .def_property_readonly(
            "irises",
            [](const FrameEstimate& e) {
                Eigen::Matrix<double, 2, 6, Eigen::RowMajor> rows;
                for (int eye = 0; eye < 2; ++eye) {
                    const SeenIris& iris = e.irises[static_cast<std::size_t>(eye)];
                    rows.row(eye) << iris.center.transpose(), iris.side, iris.opening, iris.presence,
                        iris.doubt;
                }
                return rows;
            },
            "(2, 6), left first: x, y, pixels; side of the crop, 0 if not seen; opening; presence; times the "
            "networks' error")
        .def_readonly("quality", &FrameEstimate::quality, "0 lost to 1 well explained")
        .def_readonly("held", &FrameEstimate::held, "nothing was measured: repeats the last good state")
        .def_readonly("found_again", &FrameEstimate::found_again,
                      "from search or a guess, not tracked: it may be another face")
        .def_readonly(
            "covered", &FrameEstimate::covered,
            "0 to 1: share of what is measured of the face, and turned to the camera, that something is "
            "before,\nwhich was not before it in the reference frame")
        .def_readonly("num_samples", &FrameEstimate::num_samples)
        .def_readonly("num_explained", &FrameEstimate::num_explained)
        .def_readonly("residual_px", &FrameEstimate::residual_px)
        .def_readonly("correlation", &FrameEstimate::correlation)
        .def_readonly("num_views", &FrameEstimate::num_views)
        .def_readonly("times", &FrameEstimate::times);
}

void bind_observations(py::module_& m) {
    py::class_<SkinObservations>(m, "SkinObservations",
                                 "Measured positions of K points of the skin in one frame, by flow alone.")
        .def_readonly("vertices", &SkinObservations::vertices,
                      "(K, 3) int32, refined vertices around each point")
        .def_readonly("barycentric", &SkinObservations::barycentric, "(K, 3), barycentric weights")
        .def_readonly("pixels", &SkinObservations::pixels, "(K, 2), in the frame")
        .def_readonly("information", &SkinObservations::information,
                      "(K, 4), rows of 2 x 2, pixels^-2; neighbours share it, outliers have 0");
}

void bind_tracker(py::module_& m) {
    py::class_<FaceTracker>(
        m, "FaceTracker",
        "Tracks one face: pose, muscles and articulators together, against reference textures.")
        .def(py::init([](const Camera& camera, QuadsIn faces, VectorIn weights, const FaceMotion& motion,
                         const ImageArray& image, const Eigen::Matrix4d& camera_from_head,
                         const FeatureInputs& features, const TrackerOptions& options, int levels,
                         std::vector<Points> rims) {
                 const ColorView view = view_image<3>(image, "the reference image");
                 const py::gil_scoped_release unlocked;
                 return FaceTracker(camera, refine_for_tracking(faces, weights, levels, std::move(rims)),
                                    motion, view, to_isometry(camera_from_head), features, options);
             }),
             "camera"_a, py::arg("faces").noconvert(), py::arg("weights").noconvert(), "motion"_a,
             py::arg("image").noconvert(), "camera_from_head"_a, "features"_a = FeatureInputs{},
             "options"_a = TrackerOptions{}, "levels"_a = 1, "rims"_a = std::vector<Points>(),
             py::keep_alive<1, 8>(),
             "faces: (F, 4) int32 quads of the skin's vertices; weights: (V,) 0 to 1, 0 keeps a vertex out "
             "of the\n"
             "measurement; image: (H, W, 3) uint8, the reference frame, where the face is at "
             "camera_from_head (4, 4)\n"
             "with all values 0; levels: of subdivision; rims: of glasses (`glasses_rims`). Raises "
             "InvalidInput.")
        .def(
            "advance",
            [](FaceTracker& tracker, const ImageArray& image, const std::optional<Eigen::Matrix4d>& guess) {
                const ColorView view = view_image<3>(image, "the frame");
                const auto pose = guess ? std::optional(to_isometry(*guess)) : std::nullopt;
                const py::gil_scoped_release unlocked;
                return tracker.advance(view, pose);
            },
            py::arg("image").noconvert(), "guess"_a = py::none(),
            "FrameEstimate of the next frame.\n\nimage: (H, W, 3) uint8; guess: (4, 4) where a detector sees "
            "the head,\n"
            "used when the face was lost.")
        .def("observations", &FaceTracker::observations,
             "SkinObservations behind the last frame's estimate; none where the face was lost.")
        .def(
            "outline",
            [](const FaceTracker& tracker, const ImageArray& image) {
                const ColorView view = view_image<3>(image, "the frame");
                const py::gil_scoped_release release;
                return tracker.outline(view);
            },
            "image"_a,
            "SkinObservations of the face's outline before what is behind the head, in the frame that was "
            "just\nadvanced to; each tells of the direction across the outline alone. None where the face "
            "was lost.\nRaises InvalidInput.")
        .def(
            "restart",
            [](FaceTracker& tracker, const ImageArray& image, const FrameEstimate& estimate) {
                tracker.restart(view_image<3>(image, "the frame"), estimate);
            },
            py::arg("image").noconvert(), "estimate"_a,
            "Goes back to a frame's state, to track the clip in the other direction; reference textures are "
            "kept.");
    m.def(
        "smooth",
        [](const std::vector<FrameEstimate>& estimates, const FaceMotion& motion,
           const SmootherOptions& options, const std::optional<Progress>& progress) {
            return smooth(estimates, motion, options, progress.value_or(Progress{}));
        },
        "estimates"_a, "motion"_a, "options"_a = SmootherOptions{}, "progress"_a = py::none(),
        py::call_guard<py::gil_scoped_release>(),
        "The most probable states of a whole clip, without lag and within the bounds, one per estimate.");
}

}  // namespace

void bind_solve(py::module_& m) {
    bind_options(m);
    bind_model(m);
    bind_estimate(m);
    bind_observations(m);
    bind_tracker(m);
}

}  // namespace mimetic::bindings
