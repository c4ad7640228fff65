// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/fit.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_fit(py::module_& m) {
    py::class_<FaceModel>(m, "FaceModel",
                          "A head that changes with identity coefficients; metres, head frame.")
        .def(
            py::init([](const Points& points, const MatrixRows& modes, const Eigen::VectorXd& spread,
                        const MatrixRows& limits, const Quads& faces, std::vector<bool> on_outline,
                        std::vector<std::string> landmark_names, const MatrixRows& landmark_weights,
                        std::vector<std::string> curve_names, std::vector<std::vector<int>> curves) {
                FaceModel model{points,
                                modes,
                                spread,
                                limits,
                                faces,
                                std::move(on_outline),
                                std::move(landmark_names),
                                landmark_weights.sparseView(),
                                std::move(curve_names),
                                std::move(curves)};
                model.check();
                return model;
            }),
            "points"_a, "modes"_a, "spread"_a, "limits"_a, "faces"_a, "on_outline"_a, "landmark_names"_a,
            "landmark_weights"_a, "curve_names"_a, "curves"_a,
            "points: P x 3; modes: I x 3P; spread: I; limits: I x 2; faces: F x 4; on_outline: P of 0 or 1;\n"
            "landmark_weights: L x P, rows sum to 1");
    py::class_<FaceEstimate>(m, "FaceEstimate", "Pose, focal length and proportions of one face.")
        .def(py::init(
                 [](const Eigen::Matrix4d& camera_from_head, double focal, const Eigen::VectorXd& identity) {
                     FaceEstimate estimate;
                     estimate.camera_from_head.matrix() = camera_from_head;
                     estimate.focal = focal;
                     estimate.identity = identity;
                     return estimate;
                 }),
             "camera_from_head"_a, "focal"_a, "identity"_a)
        .def_property_readonly("camera_from_head",
                               [](const FaceEstimate& e) { return MatrixRows(e.camera_from_head.matrix()); })
        .def_readonly("focal", &FaceEstimate::focal)
        .def_property_readonly("identity", [](const FaceEstimate& e) { return e.identity; })
        .def_readonly("rms_ipd", &FaceEstimate::rms_ipd)
        .def_readonly("iterations", &FaceEstimate::iterations)
        .def_readonly("converged", &FaceEstimate::converged);
    m.def(
        "fit_face",
        [](const FaceModel& model, const FaceFeatures& features, const Camera& camera, bool focal_free) {
            FitOptions options;
            options.focal_free = focal_free;
            return fit_face(model, features, camera, options);
        },
        "model"_a, "features"_a, "camera"_a, "focal_free"_a = false, py::call_guard<py::gil_scoped_release>(),
        "Pose, scale and proportions that put the model on the features.\n\nreturns: FaceEstimate, metres "
        "and pixels");
    m.def("project_features", &project_features, "model"_a, "estimate"_a, "camera"_a,
          py::call_guard<py::gil_scoped_release>(),
          "Landmarks and curves of the fitted model in the image, pixels.");
}

}  // namespace mimetic::bindings
