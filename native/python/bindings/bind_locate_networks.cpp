// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <mimetic/locate/eye_regressor.hpp>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/locate/feature_noise.hpp>
#include <mimetic/locate/network_features.hpp>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/passing_cover.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_feature_noise(py::module_& m) {
    py::class_<FeatureNoise>(m, "FeatureNoise", "Of a network's point; sides of its crop, along and across.")
        .def_property_readonly(
            "jitter", [](const FeatureNoise& n) { return n.jitter; }, "(2,) from frame to frame")
        .def_property_readonly(
            "error", [](const FeatureNoise& n) { return n.error; }, "(2,) beside the person's bias");
    m.def(
        "feature_noise",
        [](const std::string& feature, double side) {
            using enum NetworkFeature;
            static const std::map<std::string, NetworkFeature> features{
                {"upper_lid", upper_lid}, {"lower_lid", lower_lid},       {"eye_corner", eye_corner},
                {"iris", iris},           {"mouth_corner", mouth_corner}, {"outer_lip", outer_lip},
                {"inner_lip", inner_lip}};
            const auto entry = features.find(feature);
            if (entry == features.end()) throw InvalidInput("feature has no such value: " + feature);
            return feature_noise(entry->second, side);
        },
        "feature"_a, "side"_a,
        "Errors of the networks at a feature.\n\nside: of the crop, pixels\nreturns: FeatureNoise");
}

/// One eye, by networks or by the regressor. returned: what of its EyePoints there is.
template <typename Source>
void bind_eye(py::class_<Source>& source, const std::string& returned) {
    source.def(
        "eye",
        [](const Source& self, const ImageArray& image, const FeatureCrop& crop, bool left) {
            const ColorView view = view_image<3>(image, "image");
            py::gil_scoped_release release;
            return self.eye(view, crop, left);
        },
        py::arg("image").noconvert(), "crop"_a, "left"_a,
        ("One eye in a crop 2.3 times as wide as it.\n\nimage: (H, W, 3) uint8 RGB\n"
         "left: the subject's left eye\nreturns: " +
         returned)
            .c_str());
}

void bind_occlusion(py::module_& m) {
    py::class_<Occlusion>(m, "Occlusion", "How probably something is before a face.")
        .def_readonly("square", &Occlusion::square, "FeatureCrop that the cells divide")
        .def_property_readonly(
            "cells", [](const Occlusion& o) { return o.cells; }, "(24, 24) 0 to 1, from the top left")
        .def(
            "at",
            [](const Occlusion& self, const Points2& pixels) {
                Eigen::VectorXd shares(pixels.rows());
                for (Eigen::Index i = 0; i < pixels.rows(); ++i)
                    shares[i] = self.at(pixels.row(i).transpose());
                return shares;
            },
            "pixels"_a, "(K,) at pixels (K, 2) of the picture; 0 beside the square")
        .def("share", &Occlusion::share, "probability"_a = .5,
             "0 to 1: of a frontal face, what is hidden by more than a probability")
        .def("is_sure", &Occlusion::is_sure, "whether something is before the face without doubt");
    py::class_<OcclusionNetwork>(m, "OcclusionNetwork", "Sees what is before a face.")
        .def(py::init<const std::string&>(), "file"_a,
             "ONNX file of scripts/train_occlusion. Raises UnreadableMedia.")
        .def(
            "see",
            [](const OcclusionNetwork& self, const ImageArray& image, const FeatureCrop& square) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                return self.see(view, square);
            },
            py::arg("image").noconvert(), "square"_a,
            "Occlusion of a face.\n\nimage: (H, W, 3) uint8 RGB; square: `occlusion_square`. Raises "
            "InvalidInput:\nit lies beside the picture.");
    m.def(
        "occlusion_square",
        [](const Camera& camera, const Eigen::Matrix4d& camera_from_head) {
            return occlusion_square(camera, to_isometry(camera_from_head));
        },
        "camera"_a, "camera_from_head"_a,
        "FeatureCrop that an OcclusionNetwork is shown, of the head at a pose. Raises InvalidInput.");
    m.def(
        "occlusion_square", [](const FaceFeatures& face) { return occlusion_square(face); }, "face"_a,
        "The same of a face that was found, about.");
    m.def("passing_shares", &passing_shares, "frames"_a,
          "(F,) the share of the face, 0 to 1, that is surely hidden in each Occlusion of a clip by what "
          "passes: not\nby what most of them have at the same place of the picture. Raises InvalidInput.");
}

void bind_locate_networks(py::module_& m) {
    bind_feature_noise(m);
    py::class_<FeatureCrop>(m, "FeatureCrop", "A square of the picture, turned upright; pixels and radians.")
        .def(py::init([](const Eigen::Vector2d& center, double side, double roll) {
                 FeatureCrop crop{center, side, roll};
                 crop.check();
                 return crop;
             }),
             "center"_a, "side"_a, "roll"_a = 0.0, "Raises InvalidInput.")
        .def_property_readonly("center", [](const FeatureCrop& c) { return c.center; })
        .def_readonly("side", &FeatureCrop::side)
        .def_readonly("roll", &FeatureCrop::roll);
    m.def(
        "crop_round",
        [](const Camera& camera, const Eigen::Matrix4d& camera_from_head, const Eigen::Vector3d& point,
           double side) { return crop_round(camera, to_isometry(camera_from_head), point, side); },
        "camera"_a, "camera_from_head"_a, "point_in_head"_a, "side"_a,
        "FeatureCrop round a point of the head; metres. Raises InvalidInput.");
    py::class_<FeatureCrops>(m, "FeatureCrops", "The squares for the whole face and both eyes.")
        .def_readonly("face", &FeatureCrops::face)
        .def_property_readonly(
            "eyes", [](const FeatureCrops& c) { return std::make_pair(c.eyes[0], c.eyes[1]); }, "left first");
    m.def(
        "feature_crops",
        [](const Camera& camera, const Eigen::Matrix4d& camera_from_head, const Points& anchors) {
            return feature_crops(camera, to_isometry(camera_from_head), anchors);
        },
        "camera"_a, "camera_from_head"_a, "anchors"_a,
        "FeatureCrops of one frame.\n\nanchors: (6, 3) metres, head frame: hairline, menton, outer and inner "
        "corner\nof the left eye, and of the right one. Raises InvalidInput.");
    py::class_<MeshPoints>(m, "MeshPoints", "The 468 points of MediaPipe's face mesh.")
        .def_property_readonly(
            "places", [](const MeshPoints& p) { return p.places; }, "(468, 2) pixels")
        .def_property_readonly(
            "depth", [](const MeshPoints& p) { return p.depth; }, "(468,) pixels, smaller is nearer")
        .def_readonly("presence", &MeshPoints::presence, "0 to 1")
        .def_property_readonly(
            "irises", [](const MeshPoints& p) { return std::make_pair(p.irises[0], p.irises[1]); },
            "(5, 2) pixels each, left first, as EyePoints'; (0, 2) without the eyes' heads");
    py::class_<EyePoints>(m, "EyePoints", "What the iris network, or a regressor, measures of one eye.")
        .def_property_readonly(
            "contour", [](const EyePoints& p) { return p.contour; },
            "(71, 2) pixels, of lids and brow, the first 16 round the eye")
        .def_property_readonly(
            "iris", [](const EyePoints& p) { return p.iris; },
            "(5, 2) pixels: centre, four points of the rim")
        .def_readonly("lid_doubt", &EyePoints::lid_doubt, "times the network's usual error, of the lids")
        .def_readonly("iris_doubt", &EyePoints::iris_doubt, "the same of the iris");
    py::class_<FeatureNetworks> networks(m, "FeatureNetworks", "Google's networks for face mesh and iris.");
    networks
        .def(py::init([](const std::string& mesh_file, const std::string& iris_file,
                         const std::string& lips_file, const std::string& left_eye_file,
                         const std::string& right_eye_file, const std::string& eye_points_file) {
                 return FeatureNetworks(mesh_file, iris_file,
                                        {lips_file, {left_eye_file, right_eye_file}, eye_points_file});
             }),
             "mesh_file"_a, "iris_file"_a, "lips_file"_a = "", "left_eye_file"_a = "",
             "right_eye_file"_a = "", "eye_points_file"_a = "",
             "ONNX files of scripts/make_networks; without lips' and eyes' the mesh's own points stand. "
             "eye_points_file:\nof scripts/train_eyes_and_lips; without it the iris network alone measures "
             "eyes.\nRaises UnreadableMedia.")
        .def(
            "mesh",
            [](const FeatureNetworks& self, const ImageArray& image, const FeatureCrop& crop,
               bool refine_eyes) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                return self.mesh(view, crop, refine_eyes);
            },
            py::arg("image").noconvert(), "crop"_a, "refine_eyes"_a = false,
            "The face in a crop about 1.5 times its size.\n\nimage: (H, W, 3) uint8 RGB\n"
            "refine_eyes: refine the eyes too, and measure the irises\nreturns: MeshPoints");
    bind_eye(networks, "EyePoints");
    py::class_<EyeRegressor> regressor(m, "EyeRegressor",
                                       "Lids and irises by what was fitted to drawn people.");
    regressor.def(py::init<const std::string&>(), "file"_a,
                  "ONNX file of scripts/train_eyes_and_lips. Raises UnreadableMedia.");
    bind_eye(regressor, "EyePoints, of whose contour the 16 points round the eye");
    bind_occlusion(m);
    m.def(
        "eye_features",
        [](const EyePoints& left, const EyePoints& right, double presence) {
            return eye_features({left, right}, presence);
        },
        "left_eye"_a, "right_eye"_a, "presence"_a = 1.0,
        "FaceFeatures of lids and irises alone. presence: 0 to 1, of a face.");
    m.def(
        "network_features",
        [](const MeshPoints& mesh, const EyePoints& left, const EyePoints& right) {
            return network_features(mesh, {left, right});
        },
        "mesh"_a, "left_eye"_a, "right_eye"_a,
        "FaceFeatures of eyes and mouth, with the networks' standard deviations on real faces.");
    m.def("with_network_features", &with_network_features, "landmarks"_a, "seen"_a,
          "FaceFeatures for a fit: landmarks, replaced by the networks' where both have one.\n\n"
          "The landmarks alone where the networks' eyes are elsewhere.");
    m.def("local_features", &local_features, "joined"_a, "frames"_a,
          "FaceFeatures of eyes and mouth alone, of features for a fit, with errors for a head whose lids "
          "and lips "
          "move by\nthemselves. Without lines where the networks saw nothing. frames: fitted together, which "
          "count as one.");
    m.def("eye_openings", &eye_openings, "seen"_a,
          "(2,) how far each eye is open, the left first, of its width; nan where the networks saw none.");
}

}  // namespace mimetic::bindings
