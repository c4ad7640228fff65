// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <mimetic/raster/depth.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/surface/places.hpp>
#include <mimetic/surface/shown_places.hpp>

namespace mimetic {
namespace {

constexpr double kGrazing = .1;    // cosine between normal and view below which a place is turned away
constexpr double kNearest = 1e-3;  // metres

}  // namespace

ShownPlaces show_places(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces,
                        const SkinPlaces& places) {
    const DepthMap depth = render_depth(camera, vertices_in_camera, faces);
    ShownPlaces shown;
    shown.points = places.values(vertices_in_camera);
    shown.pixels.setConstant(shown.points.rows(), 2, std::numeric_limits<double>::quiet_NaN());
    shown.visible.assign(static_cast<std::size_t>(shown.points.rows()), false);
    for (Eigen::Index i = 0; i < shown.points.rows(); ++i) {
        const Eigen::Vector3d point = shown.points.row(i);
        if (!(point.z() > kNearest)) {
            continue;
        }
        shown.pixels.row(i) = camera.project(point).transpose();
        shown.visible[static_cast<std::size_t>(i)] =
            facing_cosine(vertices_in_camera, places.corners.row(i), point) > kGrazing &&
            depth.shows(camera, point, kCovered);
    }
    return shown;
}

}  // namespace mimetic
