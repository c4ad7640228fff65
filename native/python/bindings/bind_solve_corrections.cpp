// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/solve/corrections.hpp>
#include <mimetic/solve/stored_evidence.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_correction(py::module_& m) {
    py::class_<SkinPin>(m, "SkinPin", "A point of the skin that a person put to a pixel.")
        .def(py::init<Eigen::Vector3d, MatrixRows, Eigen::Vector2d, double>(), "neutral"_a, "modes"_a,
             "pixel"_a, "std"_a,
             "neutral: (3,) metres, head frame; modes: (M, 3), of the point, metres at the value 1; pixel: "
             "(2,);\nstd: pixels.");
    py::class_<PosePin>(m, "PosePin", "The head's pose as a person put it.")
        .def(py::init([](const Eigen::Matrix4d& pose, double rotation_std, double translation_std) {
                 return PosePin{to_isometry(pose), rotation_std, translation_std};
             }),
             "camera_from_head"_a, "rotation_std"_a, "translation_std"_a,
             "camera_from_head: (4, 4); standard deviations in rad and metres.");
    py::class_<ValuePin>(m, "ValuePin", "A weighted sum of the values: one of them, or the gap of two lips.")
        .def(py::init<Eigen::VectorXd, double, double>(), "weights"_a, "target"_a, "std"_a, "weights: (M,).");
    py::class_<Correction>(m, "Correction", "What a person measured in one frame.")
        .def(py::init<int, double, std::vector<SkinPin>, std::vector<PosePin>, std::vector<ValuePin>>(),
             "index"_a, "reach"_a, "pins"_a, "poses"_a, "values"_a,
             "index: of the estimate; reach: frames before and after within which it counts.");
}

}  // namespace

void bind_solve_corrections(py::module_& m) {
    bind_correction(m);
    m.def("pack_evidence", &pack_evidence, "estimate"_a,
          "What the pictures say about an estimate's pose and values: (E,) float32, the information's lower "
          "triangle\nby rows, then the gradient.");
    m.def(
        "stored_estimate",
        [](const Eigen::Matrix4d& pose, const Matrix6& pose_covariance, VectorIn values, VectorIn values_std,
           const Eigen::VectorXf& evidence, double quality, bool is_held) {
            return stored_estimate(to_isometry(pose), pose_covariance, values, values_std, evidence, quality,
                                   is_held);
        },
        "pose"_a, "pose_covariance"_a, "values"_a, "values_std"_a, "evidence"_a, "quality"_a, "is_held"_a,
        "FrameEstimate from what a performance keeps of it.\n\n"
        "pose: (4, 4); pose_covariance: (6, 6); values, values_std: (M,); evidence: as `pack_evidence` has "
        "it. "
        "Raises\nInvalidInput where the lengths do not agree.");
    m.def(
        "smooth_corrected",
        [](const std::vector<FrameEstimate>& estimates, const FaceMotion& motion, const Camera& camera,
           const std::vector<Correction>& corrections, const SmootherOptions& options,
           const std::optional<Progress>& progress) {
            return smooth_corrected(estimates, motion, camera, corrections, options,
                                    progress.value_or(Progress{}));
        },
        "estimates"_a, "motion"_a, "camera"_a, "corrections"_a, "options"_a = SmootherOptions{},
        "progress"_a = py::none(), py::call_guard<py::gil_scoped_release>(),
        "As `smooth`, of successive frames, with what a person measured beside what the pictures show. "
        "Raises\nInvalidInput.");
    m.def("bias_correlation", &bias_correlation, "num_frames"_a, "reach"_a,
          "How much of a correction counts so many frames away, 0 to 1.");
}

}  // namespace mimetic::bindings
