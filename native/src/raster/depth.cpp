// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/raster/depth.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kNearest = 1e-3;  // metres

}  // namespace

bool DepthMap::shows(const Camera& camera, const Eigen::Vector3d& point_in_camera, double tolerance) const {
    if (!(point_in_camera.z() > kNearest)) {
        return false;
    }
    const Eigen::Vector2d pixel = camera.project(point_in_camera);
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < cols - 0.5 && pixel.y() < rows - 0.5)) {
        return false;
    }
    const auto x = static_cast<int>(std::lround(pixel.x()));
    const auto y = static_cast<int>(std::lround(pixel.y()));
    return point_in_camera.z() <= depth[index(x, y)] + tolerance;
}

DepthMap render_depth(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces) {
    camera.check();
    if (!vertices_in_camera.allFinite()) {
        throw InvalidInput("a vertex of the mesh is not finite");
    }
    if (faces.size() > 0 && (faces.minCoeff() < 0 || faces.maxCoeff() >= vertices_in_camera.rows())) {
        throw InvalidInput("a face names a vertex outside 0 to " +
                           std::to_string(vertices_in_camera.rows() - 1));
    }
    const auto count = static_cast<std::size_t>(vertices_in_camera.rows());
    std::vector<Eigen::Vector2d> pixels(count, Eigen::Vector2d::Zero());
    std::vector<double> inverse_z(count, -1);
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d point = vertices_in_camera.row(static_cast<Eigen::Index>(i));
        if (point.z() > kNearest) {
            pixels[i] = camera.project(point);
            inverse_z[i] = 1 / point.z();
        }
    }
    DepthMap map(camera.height, camera.width);
    for (int f = 0; f < faces.rows(); ++f) {
        const auto vertex = [&](int k) { return static_cast<std::size_t>(faces(f, k)); };
        if (!(std::min({inverse_z[vertex(0)], inverse_z[vertex(1)], inverse_z[vertex(2)],
                        inverse_z[vertex(3)]}) > 0)) {
            continue;
        }
        for (const auto& [a, b, c] : kQuadHalves) {
            // 1 / z is linear in the image
            const Eigen::Vector3d nearness(inverse_z[vertex(a)], inverse_z[vertex(b)], inverse_z[vertex(c)]);
            fill_triangle<double>({pixels[vertex(a)], pixels[vertex(b)], pixels[vertex(c)]}, map.rows,
                                  map.cols, [&](int x, int y, const Eigen::Vector3d& weights) {
                                      map.keep_nearer(x, y, f, static_cast<float>(1 / weights.dot(nearness)));
                                  });
        }
    }
    return map;
}

}  // namespace mimetic
