// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/fit/fit.hpp>
#include <mimetic/shared/error.hpp>

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
            "landmark_weights: L x P, rows sum to 1")
        .def_readonly("landmark_names", &FaceModel::landmark_names)
        .def(
            "landmarks",
            [](const FaceModel& model, const Eigen::VectorXd& identity) {
                if (identity.size() != model.modes.rows())
                    throw InvalidInput("identity must have a value for each mode");
                return model.landmarks(identity);
            },
            "identity"_a, "(L, 3) metres, head frame. Raises InvalidInput.");
    py::class_<FaceView>(m, "FaceView", "What is known of one picture of the person.")
        .def(py::init([](FaceFeatures features, std::vector<Feature> pins, const MatrixRows& motion) {
                 if (motion.rows() > 0 && motion.cols() != 4)
                     throw InvalidInput("motion must have the shape (points, 4)");
                 FaceView view{std::move(features), std::move(pins), {}};
                 for (Eigen::Index i = 0; i < motion.rows(); ++i) {
                     view.motion.push_back(
                         {static_cast<int>(motion(i, 0)), {motion(i, 1), motion(i, 2)}, motion(i, 3)});
                 }
                 return view;
             }),
             "features"_a, "pins"_a = std::vector<Feature>{}, "motion"_a = MatrixRows(0, 4),
             "features: measured; pins: landmarks placed by hand, without robust weight\n"
             "motion: (K, 4) point of the model, how far it moved right and down since the first view, "
             "standard deviation, pixels")
        .def_readonly("features", &FaceView::features)
        .def_readonly("pins", &FaceView::pins);
    py::class_<FaceEstimate>(m, "FaceEstimate",
                             "Pose of each view, focal length and proportions of one face.")
        .def(py::init([](const std::vector<Eigen::Matrix4d>& camera_from_head, double focal,
                         const Eigen::VectorXd& identity) {
                 FaceEstimate estimate;
                 for (const auto& pose : camera_from_head) estimate.camera_from_head.emplace_back(pose);
                 estimate.focal = focal;
                 estimate.identity = identity;
                 return estimate;
             }),
             "camera_from_head"_a, "focal"_a, "identity"_a)
        .def_property_readonly("camera_from_head",
                               [](const FaceEstimate& e) {
                                   std::vector<MatrixRows> poses;
                                   for (const auto& pose : e.camera_from_head)
                                       poses.emplace_back(pose.matrix());
                                   return poses;
                               })
        .def_readonly("focal", &FaceEstimate::focal)
        .def_property_readonly("identity", [](const FaceEstimate& e) { return e.identity; })
        .def_readonly("rms_ipd", &FaceEstimate::rms_ipd)
        .def_readonly("iterations", &FaceEstimate::iterations)
        .def_readonly("converged", &FaceEstimate::converged);
    m.def(
        "fit_face",
        [](const FaceModel& model, const std::vector<FaceView>& views, const Camera& camera, bool focal_free,
           const std::optional<FaceEstimate>& start, bool shape_free, bool pose_free, double elsewhere) {
            FitOptions options;
            options.focal_free = focal_free;
            options.shape_free = shape_free;
            options.pose_free = pose_free;
            options.elsewhere = elsewhere;
            return fit_face(model, views, camera, options, start ? &*start : nullptr);
        },
        "model"_a, "views"_a, "camera"_a, "focal_free"_a = false, "start"_a = py::none(),
        "shape_free"_a = true, "pose_free"_a = true, "elsewhere"_a = FitOptions().elsewhere,
        py::call_guard<py::gil_scoped_release>(),
        "Pose of every view and the proportions and focal length that they share.\n\n"
        "start: FaceEstimate of the same views to go on from\nshape_free: whether proportions are estimated, "
        "or "
        "kept as start has them; pose_free: the same of poses\nelsewhere: factor on the standard deviations "
        "of features in views after the first\nreturns: FaceEstimate, metres and pixels");
    m.def("project_features", &project_features, "model"_a, "estimate"_a, "camera"_a, "view"_a = 0,
          py::call_guard<py::gil_scoped_release>(),
          "Landmarks and curves of the fitted model in a view's image, pixels.");
}

}  // namespace mimetic::bindings
