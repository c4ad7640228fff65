// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/locate/landmarks.hpp>
#include <mimetic/locate/rest.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_locate_landmarks(py::module_& m) {
    py::class_<LandmarkStage>(m, "LandmarkStage", "One step of a cascade of linear regressions.")
        .def(py::init<double, Eigen::VectorXd, MatrixRows, MatrixRows>(), "cell"_a, "mean"_a, "basis"_a,
             "regression"_a);
    py::class_<LandmarkView>(m, "LandmarkView", "Start and errors of landmarks for heads turned alike.")
        .def(py::init<double, Points2, Eigen::VectorXd>(), "yaw"_a, "start"_a, "sigma"_a)
        .def_readonly("yaw", &LandmarkView::yaw, "degrees")
        .def_property_readonly("sigma", [](const LandmarkView& v) { return v.sigma; });
    py::class_<FaceLandmarks>(m, "FaceLandmarks", "A cascade's estimate of one face.")
        .def_property_readonly(
            "places", [](const FaceLandmarks& f) { return f.places; }, "L x 2, pixels")
        .def_property_readonly(
            "sigma_px", [](const FaceLandmarks& f) { return f.sigma_px; }, "L")
        .def_readonly("yaw", &FaceLandmarks::yaw, "degrees, of the view");
    py::class_<LandmarkCascade>(m, "LandmarkCascade",
                                "Places of landmarks by supervised descent [Xiong and De la Torre 2013].")
        .def(py::init([](std::vector<std::string> names, const Points2& reference,
                         std::vector<LandmarkView> views, std::vector<LandmarkStage> stages) {
                 LandmarkCascade cascade{std::move(names), reference, std::move(views), std::move(stages)};
                 cascade.check();
                 return cascade;
             }),
             "names"_a, "reference"_a, "views"_a, "stages"_a, "Raises InvalidInput where sizes do not agree.")
        .def_readonly("names", &LandmarkCascade::names)
        .def_readonly("views", &LandmarkCascade::views)
        .def(
            "start",
            [](const LandmarkCascade& cascade, const Eigen::Vector2d& right, const Eigen::Vector2d& left,
               double yaw) { return landmark_start(cascade, right, left, yaw); },
            "pupil_right"_a, "pupil_left"_a, "yaw"_a,
            "Average places (L, 2) of a head turned by `yaw` degrees; pupils in pixels.")
        .def(
            "settle",
            [](const LandmarkCascade& cascade, const ImageArray& image, const Points2& start) {
                const ColorView view = view_image<3>(image, "image");
                const py::gil_scoped_release release;
                return settle_landmarks(view, cascade, start);
            },
            py::arg("image").noconvert(), "start"_a,
            "As find; where the face turns out of another size than its pupils said, it starts again from "
            "what "
            "it found.")
        .def(
            "find",
            [](const LandmarkCascade& cascade, const ImageArray& image, const Points2& start) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                return find_landmarks(view, cascade, start);
            },
            py::arg("image").noconvert(), "start"_a,
            "The landmarks of a face.\n\nimage: (H, W, 3) uint8 RGB\nstart: (L, 2) pixels\n"
            "returns: FaceLandmarks");
    py::class_<RestSigns>(m, "RestSigns",
                          "What tells of a face in an image whether it is at rest; contrasts and brightness "
                          "are relative\nto the skin's brightness.")
        .def_readonly("frontal", &RestSigns::frontal)
        .def_readonly("mouth_contrast", &RestSigns::mouth_contrast)
        .def_readonly("mouth_edges", &RestSigns::mouth_edges)
        .def_readonly("cheek_contrast", &RestSigns::cheek_contrast)
        .def_readonly("pupil_brightness", &RestSigns::pupil_brightness);
    m.def(
        "rest_signs",
        [](const ImageArray& image, const FaceFeatures& face) {
            const ColorView view = view_image<3>(image, "image");
            const py::gil_scoped_release release;
            return rest_signs(view, face);
        },
        py::arg("image").noconvert(), "face"_a, "Of a face in an image (H, W, 3).");
    m.def("rest_scores", &rest_scores, "frames"_a,
          "(F,) how much a face is at rest in each of a clip's frames (RestSigns), 0 to 1: frontal, level, "
          "eyes open,\nmouth at rest.");
    m.def(
        "face_detail",
        [](const ImageArray& image, const FaceFeatures& face) {
            const ColorView view = view_image<3>(image, "image");
            const py::gil_scoped_release release;
            return face_detail(view, face);
        },
        py::arg("image").noconvert(), "face"_a,
        "Fine detail of a face in an image (H, W, 3), grey levels: blur and strong compression "
        "remove it.");
    m.def("expression_of", &expression_of, "face"_a,
          "(6,) heights of brows and mouth corners below the pupils, the lips' height and the mouth's width, "
          "pupil\n"
          "distances; nan where a feature was not found.");
    m.def(
        "usual_expression", &usual_expression, "expressions"_a, "scores"_a, "rest"_a = py::none(),
        "(F,) how near each frame's expression (F, 6) is to its clip's median, 0 to 1. scores: (F,) of "
        "rest_scores; "
        "where\nmost frames are plainly not at rest, the others alone say what is usual. rest: index of the "
        "frame that is\nknown to show rest: how near to it.");
    m.def("costs_of_rest", &costs_of_rest, "values"_a, "lids"_a, "scores"_a, "details"_a, "covered_lids"_a,
          "(F,) how little a frame serves as rest; the least is the best. values: (F, M) of what moves the "
          "skin, relative\nto any one of the frames; lids: (F, L), 1 where shut; scores, details: (F,) of "
          "rest_scores, "
          "face_detail; covered_lids: (C, L) of frames with a hand before the face, which serve as no "
          "rest.");
    m.def("num_alike", &num_alike, "expressions"_a, "frame"_a,
          "How many frames have the expression (F, 6) of the one at index `frame`, it among them.");
    m.def(
        "distinct_first", &distinct_first, "chances"_a, "expressions"_a,
        "Indices of frames by falling chance (F,), those whose expression (F, 6) one before them has last.");
    m.def("shared_expression", &shared_expression, "expressions"_a, "weights"_a,
          "(F,) how many frames share each frame's expression (F, 6), as a part of the most. weights: (F,).");
    m.def("chances_of_rest", &chances_of_rest, "scores"_a, "details"_a, "expressions"_a,
          "(F,) which frames of a clip serve best as its reference; the greatest is the best. details: (F,) "
          "of\n"
          "face_detail, beside what the clip's better frames have.");
    m.def(
        "landmark_descriptors",
        [](const ImageArray& image, const Points2& places, const Points2& reference, double cell) {
            const ColorView view = view_image<3>(image, "image");
            py::gil_scoped_release release;
            return landmark_descriptors(view, places, reference, cell);
        },
        py::arg("image").noconvert(), "places"_a, "reference"_a, "cell"_a,
        "Orientations of gradients round places, (L, 128).\n\nimage: (H, W, 3) uint8 RGB\n"
        "places: (L, 2) pixels\nreference: (L, 2) interpupillary distances\ncell: the same");
}

}  // namespace mimetic::bindings
