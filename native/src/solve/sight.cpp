// SPDX-License-Identifier: GPL-3.0-or-later
#include "sight.hpp"

namespace mimetic {

namespace {

constexpr float kBehind = .012f;  // metres: thicker than a raster cell's slope

/// Metres by which skin's depth may have changed from one pose to another, at most.
double depth_change(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after) {
    constexpr double kFarthestSkin = .12;  // metres from the head's origin
    const double turn = Eigen::AngleAxisd(after.linear() * before.linear().transpose()).angle();
    return std::abs(after.translation().z() - before.translation().z()) + kFarthestSkin * turn;
}

}  // namespace

float turned_to_camera(const ReferenceSample& sample, const Triangles& triangles,
                       const ProjectedSurface& projected, const Eigen::Vector3f& eye) {
    const auto corners = triangles.row(sample.triangle);
    const Eigen::Vector3f first = projected.points_in_head.row(corners[0]);
    const Eigen::Vector3f normal = (projected.points_in_head.row(corners[1]).transpose() - first)
                                       .cross(projected.points_in_head.row(corners[2]).transpose() - first)
                                       .normalized();
    constexpr float kGrazing = .2F;
    return std::clamp((normal.dot((eye - first).normalized()) - kGrazing) / .3F, 0.F, 1.F);
}

Eigen::Vector3f eye_in_head(const FaceState& state) {
    return state.camera_from_head.inverse().translation().cast<float>();
}

void Sight::draw(const ProjectedSurface& projected, const FaceState& state, double face_height) {
    constexpr int kRasterHeight = 80;  // of the face
    const Eigen::Vector2d head = face_.camera.project(state.camera_from_head.translation());
    grid_.scale = std::min(1., kRasterHeight / face_height);
    grid_.origin = head - Eigen::Vector2d::Constant(1.2 * face_height);
    grid_.rows = grid_.cols = static_cast<int>(2.4 * face_height * grid_.scale);
    raster_surface(projected, face_.surface.triangles(), grid_, raster_);
    drawn_ = state.camera_from_head;
}

void Sight::follow(const ProjectedSurface& projected, const FaceState& state, double face_height) {
    if (depth_change(drawn_, state.camera_from_head) > kBehind / 3) {
        draw(projected, state, face_height);
    }
}

std::vector<float> Sight::visible(const ReferenceView& view, const ProjectedSurface& projected,
                                  const FaceState& state) const {
    const Eigen::Vector3f eye = eye_in_head(state);
    std::vector<float> visible(view.samples().size());
    for (std::size_t k = 0; k < visible.size(); ++k) {
        const ReferenceSample& sample = view.samples()[k];
        const auto corners = face_.surface.triangles().row(sample.triangle);
        visible[k] = turned_to_camera(sample, face_.surface.triangles(), projected, eye);
        const Eigen::Vector2f pixel = projected.pixels.row(corners[0]);
        if (pixel.x() < 1 || pixel.y() < 1 || pixel.x() > static_cast<float>(face_.camera.width - 2) ||
            pixel.y() > static_cast<float>(face_.camera.height - 2)) {
            visible[k] = 0;
            continue;
        }
        if (cover_.hides(pixel.cast<double>())) {
            visible[k] = 0;
            continue;
        }
        const Eigen::Vector2d cell = (pixel.cast<double>() - grid_.origin) * grid_.scale;
        const int x = static_cast<int>(std::lround(cell.x())), y = static_cast<int>(std::lround(cell.y()));
        const bool is_drawn = x >= 0 && y >= 0 && x < raster_.cols && y < raster_.rows;
        if (is_drawn && projected.depths[corners[0]] > raster_.depth[raster_.index(x, y)] + kBehind) {
            visible[k] = 0;
        }
    }
    return visible;
}

}  // namespace mimetic
