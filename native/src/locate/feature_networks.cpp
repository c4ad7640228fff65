// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace mimetic {
namespace {

constexpr std::uintmax_t kLargestFile = 16u << 20;
// MediaPipe shows its mesh a square 1.5 times the box of the mesh's own points, its iris network one of 2.3
// times the eye. That box, in heights from the hairline to the menton: on eight frames of four clips its side
// is 0.87 (deviation 0.014), its middle lies 0.05 (0.005) towards the menton.
constexpr double kFaceMargin = 1.3, kTowardsMenton = 0.55, kEyeMargin = 2.3;
constexpr int kMeshSide = 192;
constexpr int kEyeSide = 64;
constexpr double kLargestSide = 1 << 16;  // pixels

std::vector<char> content_of(const std::string& file) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure)) {
        throw UnreadableMedia(file + ": no such file; scripts/make_networks makes it");
    }
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    if (failure || size == 0 || size > kLargestFile) {
        throw UnreadableMedia(file +
                              ": not a network of ours, which have up to 16 MB; run "
                              "scripts/make_networks again");
    }
    std::vector<char> content(size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
        throw UnreadableMedia(file + ": cannot be read");
    }
    return content;
}

/// The outputs (rows of float32) of a network for an input, in the order of their lengths.
std::vector<cv::Mat> outputs_of(cv::dnn::Net& net, const cv::Mat& blob) {
    net.setInput(blob);
    std::vector<cv::Mat> outputs;
    // In one thread: layers this small lose more by waiting for helpers than they win, a lot more where other
    // programs keep the processors busy. OpenCV divides no work inside work that it divides.
    cv::parallel_for_({0, 1},
                      [&](const cv::Range&) { net.forward(outputs, net.getUnconnectedOutLayersNames()); });
    std::sort(outputs.begin(), outputs.end(),
              [](const cv::Mat& a, const cv::Mat& b) { return a.total() < b.total(); });
    return outputs;
}

/// A network whose outputs have the wanted lengths, rising; tried once, as a damaged file shows then.
cv::dnn::Net load(const std::string& file, int side, const std::vector<std::size_t>& lengths) {
    const std::vector<char> content = content_of(file);
    bool fits = false;
    cv::dnn::Net net;
    try {
        net = cv::dnn::readNetFromONNX(content.data(), content.size());
        net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
        const int shape[] = {1, 3, side, side};
        const std::vector<cv::Mat> outputs = outputs_of(net, cv::Mat(4, shape, CV_32F, cv::Scalar(0.5)));
        fits = outputs.size() == lengths.size();
        for (std::size_t i = 0; fits && i < lengths.size(); ++i) {
            fits = outputs[i].total() == lengths[i] && outputs[i].type() == CV_32F &&
                   outputs[i].isContinuous() && cv::checkRange(outputs[i]);
        }
    } catch (const cv::Exception&) {
    }
    if (!fits) {
        throw UnreadableMedia(file + ": damaged, or not a network of ours; run scripts/make_networks again");
    }
    return net;
}

/// Pixels of the picture from places in the crop, whose sides go from 0 to 1.
Eigen::Matrix<double, 2, 3> image_from_crop(const FeatureCrop& crop) {
    const double c = std::cos(crop.roll) * crop.side, s = std::sin(crop.roll) * crop.side;
    Eigen::Matrix<double, 2, 3> map;
    map << c, -s, crop.center.x() - 0.5 * (c - s),  //
        s, c, crop.center.y() - 0.5 * (s + c);
    return map;
}

/// The crop as a network takes it: 1 x 3 x side x side, red green blue in 0 to 1. What lies beside the
/// picture repeats its border.
cv::Mat blob_of(ColorView image, const FeatureCrop& crop, int side, bool mirrored) {
    cv::Mat picture(image.rows, image.cols, CV_8UC3, const_cast<std::uint8_t*>(image.data),
                    static_cast<std::size_t>(image.stride));
    Eigen::Matrix<double, 2, 3> map = image_from_crop(crop);
    // Halves of the part that is seen, so that no detail is skipped over
    const double reach = 0.75 * crop.side;
    const cv::Rect whole(0, 0, picture.cols, picture.rows);
    const cv::Rect part =
        whole & cv::Rect(cv::Point(static_cast<int>(std::floor(crop.center.x() - reach)) - 2,
                                   static_cast<int>(std::floor(crop.center.y() - reach)) - 2),
                         cv::Point(static_cast<int>(std::ceil(crop.center.x() + reach)) + 3,
                                   static_cast<int>(std::ceil(crop.center.y() + reach)) + 3));
    if (part.width < 2 || part.height < 2) {
        throw InvalidInput("the crop lies beside the picture; follow the face before asking for its points");
    }
    picture = picture(part);
    map.col(2) -= Eigen::Vector2d(part.x, part.y);
    for (double size = crop.side; size >= 2 * side && std::min(picture.rows, picture.cols) >= 4; size /= 2) {
        cv::Mat half;
        cv::resize(picture, half, {}, 0.5, 0.5, cv::INTER_AREA);
        const Eigen::Vector2d shrunk(static_cast<double>(half.cols) / picture.cols,
                                     static_cast<double>(half.rows) / picture.rows);
        map = shrunk.asDiagonal() * map;
        map.col(2) += 0.5 * (shrunk - Eigen::Vector2d::Ones());
        picture = half;
    }
    const double step = 1.0 / side;
    cv::Matx23d warp(map(0, 0) * step, map(0, 1) * step, 0, map(1, 0) * step, map(1, 1) * step, 0);
    if (mirrored) {
        warp(0, 0) = -warp(0, 0);
        warp(1, 0) = -warp(1, 0);
    }
    const Eigen::Vector2d first =
        map * Eigen::Vector3d(mirrored ? 1 - 0.5 * step : 0.5 * step, 0.5 * step, 1);
    warp(0, 2) = first.x();
    warp(1, 2) = first.y();
    cv::Mat square;
    cv::warpAffine(picture, square, warp, {side, side}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return cv::dnn::blobFromImage(square, 1.0 / 255);
}

/// Pixels of the picture of points (x, y, z in pixels of the crop) that a network says.
Points2 places_of(const cv::Mat& output, const FeatureCrop& crop, int side, bool mirrored) {
    const float* values = output.ptr<float>();
    const Eigen::Matrix<double, 2, 3> map = image_from_crop(crop);
    Points2 places(static_cast<Eigen::Index>(output.total() / 3), 2);
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const double x = values[3 * i] / side;
        places.row(i) =
            (map * Eigen::Vector3d(mirrored ? 1 - x : x, values[3 * i + 1] / side, 1)).transpose();
    }
    return places;
}

}  // namespace

void FeatureCrop::check() const {
    if (!center.allFinite() || center.cwiseAbs().maxCoeff() > kLargestSide) {
        throw InvalidInput("center of a crop must be pixels of the picture");
    }
    if (!(side >= 4 && side <= kLargestSide)) {
        throw InvalidInput("side of a crop is " + std::to_string(side) + "; it must be 4 to 65536 pixels");
    }
    if (!std::isfinite(roll)) throw InvalidInput("roll of a crop must be finite");
}

FeatureCrop crop_round(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                       const Eigen::Vector3d& point_in_head, double side) {
    const Eigen::Vector3d point = camera_from_head * point_in_head;
    if (!(point.allFinite() && point.z() > 0)) {
        throw InvalidInput("the head is not before the camera; give the pose of a frame in which it is seen");
    }
    const Eigen::Vector2d across =
        camera.project_jacobian(point) * camera_from_head.linear().col(0);  // to the image's right
    FeatureCrop crop;
    crop.center = camera.project(point);
    crop.side = side * 0.5 * (camera.fx + camera.fy) / point.z();
    crop.roll = std::atan2(across.y(), across.x());
    crop.check();
    return crop;
}

FeatureCrops feature_crops(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                           PointsIn anchors) {
    if (anchors.rows() != 6) {
        throw InvalidInput("anchors has " + std::to_string(anchors.rows()) + " rows; it must have 6");
    }
    const auto at = [&](int row) -> Eigen::Vector3d { return anchors.row(row).transpose(); };
    FeatureCrops crops;
    Eigen::Vector3d middle = (1 - kTowardsMenton) * at(0) + kTowardsMenton * at(1);
    middle.z() = 0.5 * (at(2) + at(4)).z();  // of the face's sides, which turn about it
    crops.face = crop_round(camera, camera_from_head, middle, kFaceMargin * (at(0) - at(1)).norm());
    for (int eye = 0; eye < 2; ++eye) {
        const Eigen::Vector3d outer = at(2 + 2 * eye), inner = at(3 + 2 * eye);
        crops.eyes[eye] =
            crop_round(camera, camera_from_head, 0.5 * (outer + inner), kEyeMargin * (outer - inner).norm());
    }
    return crops;
}

struct FeatureNetworks::Nets {
    std::mutex busy;
    cv::dnn::Net mesh;
    cv::dnn::Net iris;
};

FeatureNetworks::FeatureNetworks(const std::string& mesh_file, const std::string& iris_file)
    : nets_(std::make_unique<Nets>()) {
    nets_->mesh = load(mesh_file, kMeshSide, {1, 3 * MeshPoints::kCount});
    nets_->iris = load(iris_file, kEyeSide, {3 * EyePoints::kIris, 3 * EyePoints::kContour});
}

FeatureNetworks::~FeatureNetworks() = default;
FeatureNetworks::FeatureNetworks(FeatureNetworks&&) noexcept = default;
FeatureNetworks& FeatureNetworks::operator=(FeatureNetworks&&) noexcept = default;

MeshPoints FeatureNetworks::mesh(ColorView image, const FeatureCrop& crop) const {
    check_image_size(image.rows, image.cols, "image");
    crop.check();
    const cv::Mat blob = blob_of(image, crop, kMeshSide, false);
    const std::lock_guard lock(nets_->busy);
    const std::vector<cv::Mat> outputs = outputs_of(nets_->mesh, blob);
    MeshPoints points;
    points.places = places_of(outputs[1], crop, kMeshSide, false);
    points.depth.resize(MeshPoints::kCount);
    for (int i = 0; i < MeshPoints::kCount; ++i) {
        points.depth(i) = outputs[1].ptr<float>()[3 * i + 2] * crop.side / kMeshSide;
    }
    points.presence = 1 / (1 + std::exp(-static_cast<double>(outputs[0].ptr<float>()[0])));
    return points;
}

EyePoints FeatureNetworks::eye(ColorView image, const FeatureCrop& crop, bool left) const {
    check_image_size(image.rows, image.cols, "image");
    crop.check();
    const cv::Mat blob = blob_of(image, crop, kEyeSide, left);
    const std::lock_guard lock(nets_->busy);
    const std::vector<cv::Mat> outputs = outputs_of(nets_->iris, blob);
    return {places_of(outputs[1], crop, kEyeSide, left), places_of(outputs[0], crop, kEyeSide, left)};
}

}  // namespace mimetic
