// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/locate/cascade.hpp>
#include <mimetic/locate/glasses.hpp>
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/well_lit.hpp>
#include <optional>

#include "arrays.hpp"
#include "picture_arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_locate(py::module_& m) {
    py::class_<Feature>(m, "Feature", "A named point of the face in the image, pixels.")
        .def(py::init(
                 [](std::string name, const Eigen::Vector2d& position, double sigma_px, double likelihood) {
                     return Feature{std::move(name), position, sigma_px, likelihood};
                 }),
             "name"_a, "position"_a, "sigma_px"_a = 1.0, "likelihood"_a = 1.0)
        .def_readonly("name", &Feature::name)
        .def_property_readonly("position", [](const Feature& f) { return f.position; })
        .def_readonly("sigma_px", &Feature::sigma_px)
        .def_readonly("likelihood", &Feature::likelihood, "0 guessed from proportions to 1 clearly visible");
    py::class_<FeatureCurve>(m, "FeatureCurve",
                             "A line of the face in the image; only its place along the normals is measured.")
        .def(py::init([](std::string name, const Points2& points, const Points2& normals,
                         const Eigen::VectorXd& sigma_px) {
                 return FeatureCurve{std::move(name), points, normals, sigma_px};
             }),
             "name"_a, "points"_a, "normals"_a, "sigma_px"_a)
        .def_readonly("name", &FeatureCurve::name)
        .def_property_readonly("points", [](const FeatureCurve& c) { return c.points; })
        .def_property_readonly("normals", [](const FeatureCurve& c) { return c.normals; })
        .def_property_readonly("sigma_px", [](const FeatureCurve& c) { return c.sigma_px; });
    py::class_<FaceFeatures>(m, "FaceFeatures", "Measurements of one face: box, points and curves, pixels.")
        .def(py::init([](std::vector<Feature> features, std::vector<FeatureCurve> curves,
                         const Eigen::Vector4d& box, double likelihood) {
                 return FaceFeatures{box, likelihood, 0, 0, std::move(features), std::move(curves)};
             }),
             "features"_a, "curves"_a, "box"_a, "likelihood"_a)
        .def_property_readonly(
            "box", [](const FaceFeatures& f) { return f.box; }, "left, top, width, height")
        .def_readonly("likelihood", &FaceFeatures::likelihood)
        .def_readonly("yaw", &FaceFeatures::yaw, "degrees, of the view that fits best")
        .def_readonly("roll", &FaceFeatures::roll, "radians, clockwise in the picture")
        .def_readonly("features", &FaceFeatures::features)
        .def_readonly("curves", &FaceFeatures::curves);

    py::class_<FaceLocator>(m, "FaceLocator",
                            "Finds faces by eigenspaces and OpenCV's Haar cascades and measures them.")
        .def(py::init([](const std::string& cascade_directory, double smallest_face, double least_likelihood,
                         const std::optional<FaceSpaces>& spaces) {
                 const LocateOptions options{smallest_face, least_likelihood};
                 return spaces ? FaceLocator(cascade_directory, *spaces, options)
                               : FaceLocator(cascade_directory, options);
             }),
             "cascade_directory"_a, "smallest_face"_a = LocateOptions{}.smallest_face,
             "least_likelihood"_a = LocateOptions{}.least_likelihood, "spaces"_a = std::nullopt,
             "spaces: FaceSpaces, used beside the cascades")
        .def(
            "locate",
            [](const FaceLocator& locator, const ImageArray& image) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                return locator.locate(view);
            },
            py::arg("image").noconvert(),
            "Every face, the largest first.\n\nimage: (H, W, 3) uint8 RGB; grey as three equal channels\n"
            "returns: list of FaceFeatures");
    py::class_<CascadeHit>(m, "CascadeHit", "A window that passed every stage of a cascade.")
        .def_property_readonly(
            "box", [](const CascadeHit& h) { return h.box; }, "left, top, width, height, pixels")
        .def_readonly("votes", &CascadeHit::votes, "overlapping windows merged into this one");
    py::class_<CascadeDetector>(m, "CascadeDetector",
                                "One of OpenCV's boosted cascades by itself, to compare with.")
        .def(py::init<const std::string&>(), "file"_a)
        .def(
            "detect",
            [](const CascadeDetector& detector, const ImageArray& image, double smallest) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                return detector.detect(view, smallest);
            },
            py::arg("image").noconvert(), "smallest"_a = 0.12,
            "Every hit, the most votes first.\n\nimage: (H, W, 3) uint8 RGB\n"
            "smallest: least width as a part of the image's shorter side\nreturns: list of CascadeHit");
    m.def(
        "measure_features",
        [](const ImageArray& image, const FaceFeatures& expected, double search, bool mouth_and_jaw) {
            const ColorView view = view_image<3>(image, "image");
            py::gil_scoped_release release;
            return measure_features(view, expected, search,
                                    mouth_and_jaw ? MeasuredParts::mouth_and_jaw : MeasuredParts::all);
        },
        py::arg("image").noconvert(), "expected"_a, "search"_a = 0.1, "mouth_and_jaw"_a = false,
        "Measures the features again, near where a fitted model predicts them.\n\n"
        "image: (H, W, 3) uint8 RGB\nexpected: FaceFeatures with pupil.L and pupil.R at least\n"
        "search: half width of the search, interpupillary distances\n"
        "mouth_and_jaw: measure these alone");
    m.def(
        "well_lit",
        [](const ImageArray& image, const FaceFeatures& face) {
            const ColorView view = view_image<3>(image, "image");
            std::optional<ColorImage> lit;
            {
                const py::gil_scoped_release release;
                lit = well_lit(view, crop_about(face));
            }
            return lit ? array_of(*lit) : image;
        },
        py::arg("image").noconvert(), "face"_a,
        "The picture with a badly lit face made brighter, and its darker half as bright as the other; "
        "itself\n"
        "where the face is lit evenly and well.\n\nimage: (H, W, 3) uint8 RGB\nreturns: (H, W, 3) uint8");
    m.def(
        "glasses_rims",
        [](const ImageArray& image, const Camera& camera, const Eigen::Matrix4d& camera_from_head,
           const Points& eyes) {
            const ColorView view = view_image<3>(image, "image");
            const py::gil_scoped_release release;
            return glasses_rims(view, camera, to_isometry(camera_from_head), eyes);
        },
        py::arg("image").noconvert(), "camera"_a, "camera_from_head"_a, "eyes"_a,
        "The rims of glasses that a head wears; empty where it wears none, or none that can be seen.\n\n"
        "image: (H, W, 3) uint8 RGB, the camera's; eyes: (2, 3), centres of the eyeballs, head frame, "
        "metres,\nthe subject's left one first\nreturns: curves along the lower halves of the rims and the "
        "bridge, each (N, 3), head frame, metres.\nRaises InvalidInput.");
}

}  // namespace mimetic::bindings
