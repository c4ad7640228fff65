// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "attention.hpp"
#include "joined_eye.hpp"
#include "network_file.hpp"
#include "point_regressor.hpp"
#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

using locate::load_network;
using locate::outputs_of;

// MediaPipe shows its mesh a square 1.5 times the box of the mesh's own points, its iris network one of 2.3
// times the eye. That box, in heights from the hairline to the menton: on eight frames of four clips its side
// is 0.87 (deviation 0.014), its middle lies 0.05 (0.005) towards the menton.
constexpr double kFaceMargin = 1.3, kTowardsMenton = 0.55, kEyeMargin = 2.3;
constexpr int kMeshSide = 192;
constexpr int kEyeSide = 64;
// The mesh's feature maps, and the part of them that a head is shown
constexpr std::size_t kMapsSize = 32 * 48 * 48;
constexpr std::array<int, 3> kSeen{32, 16, 16};
constexpr double kLargestSide = 1 << 16;  // pixels

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
    cv::Mat picture = as_matrix(image);
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

/// Pixels of the picture of points in sides of the crop.
Points2 in_picture(const Points2& shares, const FeatureCrop& crop, bool mirrored) {
    Eigen::Matrix<double, 2, 3> map = image_from_crop(crop);
    if (mirrored) {
        map.col(2) += map.col(0);
        map.col(0) = -map.col(0);
    }
    return (shares * map.leftCols<2>().transpose()).rowwise() + map.col(2).transpose();
}

/// Points (x, y, z in pixels of the crop) that a network gives, in sides of the crop.
Points2 shares_of(const cv::Mat& output, int side) {
    using Spatial = Eigen::Map<const Rows<float, 3>>;
    const Spatial points(output.ptr<float>(), static_cast<Eigen::Index>(output.total() / 3), 3);
    return points.leftCols<2>().cast<double>() / side;
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
    std::mutex mesh_busy;  // with its heads
    cv::dnn::Net mesh, lips;
    std::array<cv::dnn::Net, 2> eyes;
    std::mutex iris_busy;  // with the regressor
    cv::dnn::Net iris;
    locate::PointRegressor eye_points;

    /// The output of a part's head on the feature maps: refined places of the part's points.
    std::vector<cv::Mat> refine(cv::dnn::Net& head, const locate::AttentionPart& part, const cv::Mat& maps,
                                const locate::PartSquare& square, Points2& shares) {
        const std::vector<cv::Mat> outputs = outputs_of(head, locate::seen_in(maps, square));
        const Points2 points = locate::points_of(outputs.back(), square);
        for (Eigen::Index i = 0; i < points.rows(); ++i) shares.row(part.points[i]) = points.row(i);
        return outputs;
    }
};

FeatureNetworks::FeatureNetworks(const std::string& mesh_file, const std::string& iris_file,
                                 const HeadFiles& heads)
    : nets_(std::make_unique<Nets>()) {
    constexpr std::size_t kSpatial = 3, kFlat = 2;
    nets_->mesh =
        load_network(mesh_file, {3, kMeshSide, kMeshSide}, {1, kSpatial * MeshPoints::kCount, kMapsSize});
    nets_->iris = load_network(iris_file, {3, kEyeSide, kEyeSide},
                               {kSpatial * EyePoints::kIris, kSpatial * EyePoints::kContour});
    if (!heads.eye_points.empty()) {
        nets_->eye_points = locate::PointRegressor(heads.eye_points, locate::RegressedEye::kPoints,
                                                   locate::RegressedEye::kGroups);
    }
    if (!heads.lips.empty()) {
        nets_->lips = load_network(heads.lips, kSeen, {kFlat * locate::kLipsPart.points.size()});
    }
    for (int eye = 0; eye < 2; ++eye) {
        if (heads.eyes[eye].empty()) continue;
        nets_->eyes[eye] =
            load_network(heads.eyes[eye], kSeen, {kFlat * EyePoints::kIris, kFlat * EyePoints::kContour});
    }
}

FeatureNetworks::~FeatureNetworks() = default;
FeatureNetworks::FeatureNetworks(FeatureNetworks&&) noexcept = default;
FeatureNetworks& FeatureNetworks::operator=(FeatureNetworks&&) noexcept = default;

MeshPoints FeatureNetworks::mesh(ColorView image, const FeatureCrop& crop, bool refine_eyes) const {
    check_image_size(image.rows, image.cols, "image");
    crop.check();
    const cv::Mat blob = blob_of(image, crop, kMeshSide, false);
    const std::lock_guard lock(nets_->mesh_busy);
    const std::vector<cv::Mat> outputs = outputs_of(nets_->mesh, blob);
    MeshPoints points;
    points.presence = 1 / (1 + std::exp(-static_cast<double>(outputs[0].ptr<float>()[0])));
    points.depth.resize(MeshPoints::kCount);
    for (int i = 0; i < MeshPoints::kCount; ++i) {
        points.depth(i) = outputs[1].ptr<float>()[3 * i + 2] * crop.side / kMeshSide;
    }
    const Points2 first = shares_of(outputs[1], kMeshSide);
    Points2 shares = first;
    if (!nets_->lips.empty()) {
        nets_->refine(nets_->lips, locate::kLipsPart, outputs[2], locate::square_of(locate::kLipsPart, first),
                      shares);
    }
    for (int eye = 0; eye < 2; ++eye) {
        if (!refine_eyes || nets_->eyes[eye].empty()) continue;
        const locate::AttentionPart& part = locate::kEyeParts[eye];
        const locate::PartSquare square = locate::square_of(part, first);
        const cv::Mat iris = nets_->refine(nets_->eyes[eye], part, outputs[2], square, shares)[0];
        points.irises[eye] = in_picture(locate::points_of(iris, square), crop, false);
    }
    points.places = in_picture(shares, crop, false);
    return points;
}

EyePoints FeatureNetworks::eye(ColorView image, const FeatureCrop& crop, bool left) const {
    check_image_size(image.rows, image.cols, "image");
    crop.check();
    const cv::Mat blob = blob_of(image, crop, kEyeSide, left);
    EyePoints points;  // in sides of the crop
    {
        const std::lock_guard lock(nets_->iris_busy);
        const std::vector<cv::Mat> outputs = outputs_of(nets_->iris, blob);
        points = {shares_of(outputs[1], kEyeSide), shares_of(outputs[0], kEyeSide)};
        if (nets_->eye_points.is_there()) {
            points = locate::joined_eye(points, nets_->eye_points.see(blob), crop.side);
        }
    }
    return {in_picture(points.contour, crop, left), in_picture(points.iris, crop, left)};
}

}  // namespace mimetic
