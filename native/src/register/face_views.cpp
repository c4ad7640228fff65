// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/register/face_views.hpp>
#include <numbers>

#include "view_camera.hpp"

namespace mimetic {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMargin = 1.5;  // times the points' extent, the crop that the network was trained on
constexpr int kSettling = 3;     // times that the crop is laid round what was seen
// Of the mesh, as mirrored pairs: outer corners of the eyes, which say how the head is rolled
constexpr int kRightEye = 33, kLeftEye = 263;
constexpr double kStartSide = .24;  // m, the first crop on a head of the template's size

Eigen::Matrix3d turned(const ViewDirection& direction) {
    return (Eigen::AngleAxisd(direction.pitch * kDegree, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(direction.yaw * kDegree, Eigen::Vector3d::UnitY()))
        .toRotationMatrix();
}

}  // namespace

FeatureCrop crop_round_points(const Points2& places) {
    const Eigen::Vector2d across = (places.row(kLeftEye) - places.row(kRightEye)).transpose().normalized();
    const Eigen::Vector2d down(-across.y(), across.x());
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const Eigen::Vector2d at(places.row(i).dot(across), places.row(i).dot(down));
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
    }
    const Eigen::Vector2d middle = (low + high) / 2;
    return {middle.x() * across + middle.y() * down, kMargin * (high - low).maxCoeff(),
            std::atan2(across.y(), across.x())};
}

FaceView settled_view(const ShadedView& view, const FeatureNetworks& networks, FeatureCrop crop) {
    const ColorImage& picture = view.shaded.picture;
    MeshPoints seen;
    FaceView face;
    for (int round = 0; round < kSettling; ++round) {
        face.crop = crop;
        seen = networks.mesh(picture.view(), crop, true);
        crop = crop_round_points(seen.places);
        if (!(crop.side >= 16 && crop.side <= 4 * picture.cols && crop.center.allFinite() &&
              crop.center.cwiseAbs().maxCoeff() < 4 * picture.cols)) {
            break;
        }
    }
    face.presence = seen.presence;
    face.places.resize(seen.places.rows(), 3);
    for (Eigen::Index i = 0; i < seen.places.rows(); ++i) {
        face.places.row(i) = view.point(seen.places.row(i).transpose()).transpose();
    }
    return face;
}

ShadedView::ShadedView(const ShownHead& shown, const Eigen::Matrix3d& view_from_head,
                       const Eigen::Vector3d& target, double height, int size, const Eigen::Vector3d& light)
    : turn(view_from_head),
      middle(target),
      distance(kDistance * height),
      camera{size * kDistance, size * kDistance, (size - 1) / 2., (size - 1) / 2., size, size},
      head(shown.mesh) {
    head.vertices = (shown.mesh.vertices.rowwise() - middle.transpose()) * turn.transpose();
    head.normals = shown.mesh.normals * turn.transpose();
    shaded = draw_shaded(camera, head, distance, light);
}

Eigen::Vector3d ShadedView::point(const Eigen::Vector2d& pixel) const {
    return turn.transpose() * shown_point(camera, head, distance, shaded.raster, pixel) + middle;
}

Eigen::Vector2d ShadedView::pixel(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d seen = turn * (point - middle);
    return camera.project(across_view(seen, distance));
}

std::vector<ViewDirection> view_directions() {
    const std::array<Eigen::Vector3d, 3> lamps{Eigen::Vector3d(.3, .5, .8).normalized(),
                                               Eigen::Vector3d(-.3, .5, .8).normalized(),
                                               Eigen::Vector3d(0, .2, 1).normalized()};
    std::vector<ViewDirection> directions;
    for (const double yaw : {0., -17., 17., -35., 35.}) {
        for (const double pitch : {0., -12., 12.}) {
            for (const Eigen::Vector3d& lamp : lamps) {
                directions.push_back({yaw, pitch, lamp});
            }
        }
    }
    return directions;
}

std::vector<FaceView> face_views(const ShownHead& head, const FeatureNetworks& networks,
                                 const std::vector<ViewDirection>& directions,
                                 const std::vector<FeatureCrop>& starts, const Progress& progress) {
    std::vector<FaceView> views;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (progress && !progress(static_cast<double>(i) / static_cast<double>(directions.size()))) {
            break;
        }
        const ShadedView view(head, turned(directions[i]), kFaceMiddle, kFaceHeight, kViewSize,
                              directions[i].light);
        const double middle = (kViewSize - 1) / 2.;
        const FeatureCrop start{{middle, middle}, kStartSide / kFaceHeight * kViewSize, 0};
        views.push_back(settled_view(view, networks, i < starts.size() ? starts[i] : start));
    }
    return views;
}

}  // namespace mimetic
