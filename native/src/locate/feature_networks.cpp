// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>
#include <opencv2/dnn.hpp>
#include <vector>

#include "attention.hpp"
#include "crop_picture.hpp"
#include "joined_eye.hpp"
#include "network_file.hpp"
#include "point_regressor.hpp"

namespace mimetic {
namespace {

using locate::blob_of;
using locate::in_picture;
using locate::kEyeSide;
using locate::load_network;
using locate::outputs_of;

constexpr int kMeshSide = 192;
// The mesh's feature maps, and the part of them that a head is shown
constexpr std::size_t kMapsSize = 32 * 48 * 48;
constexpr std::array<int, 3> kSeen{32, 16, 16};

/// Points (x, y, z in pixels of the crop) that a network gives, in sides of the crop.
Points2 shares_of(const cv::Mat& output, int side) {
    using Spatial = Eigen::Map<const Rows<float, 3>>;
    const Spatial points(output.ptr<float>(), static_cast<Eigen::Index>(output.total() / 3), 3);
    return points.leftCols<2>().cast<double>() / side;
}

}  // namespace

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
