// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/raster/depth.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kNearest = 1e-3;  // metres

struct Corner {
    double x, y, inverse_z;
};

/// Pixels whose centres lie in a triangle keep the smaller depth; 1 / z is linear in the image.
void fill_triangle(const std::array<Corner, 3>& corners, DepthMap& map) {
    const auto& [a, b, c] = corners;
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (!(std::abs(area) > 1e-12)) {
        return;
    }
    const auto clip = [](double value, int size) {
        return static_cast<int>(std::clamp(value, -1.0, double(size)));
    };
    const int first_x = std::max(0, clip(std::ceil(std::min({a.x, b.x, c.x})), map.cols));
    const int last_x = std::min(map.cols - 1, clip(std::floor(std::max({a.x, b.x, c.x})), map.cols));
    const int first_y = std::max(0, clip(std::ceil(std::min({a.y, b.y, c.y})), map.rows));
    const int last_y = std::min(map.rows - 1, clip(std::floor(std::max({a.y, b.y, c.y})), map.rows));
    for (int y = first_y; y <= last_y; ++y) {
        float* row = map.depth.data() + std::ptrdiff_t{y} * map.cols;
        for (int x = first_x; x <= last_x; ++x) {
            const double wb = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
            const double wc = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
            const double wa = 1 - wb - wc;
            if (wa >= 0 && wb >= 0 && wc >= 0) {
                const double inverse_z = wa * a.inverse_z + wb * b.inverse_z + wc * c.inverse_z;
                row[x] = std::min(row[x], static_cast<float>(1 / inverse_z));
            }
        }
    }
}

}  // namespace

bool DepthMap::shows(const Camera& camera, const Eigen::Vector3d& point_in_camera, double tolerance) const {
    if (!(point_in_camera.z() > kNearest)) {
        return false;
    }
    const Eigen::Vector2d pixel = camera.project(point_in_camera);
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < cols - 0.5 && pixel.y() < rows - 0.5)) {
        return false;
    }
    const auto x = static_cast<std::ptrdiff_t>(std::lround(pixel.x()));
    const auto y = static_cast<std::ptrdiff_t>(std::lround(pixel.y()));
    return point_in_camera.z() <= depth[static_cast<std::size_t>(y * cols + x)] + tolerance;
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
    std::vector<Corner> corners(static_cast<std::size_t>(vertices_in_camera.rows()));
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d point = vertices_in_camera.row(static_cast<Eigen::Index>(i));
        const Eigen::Vector2d pixel = point.z() > kNearest ? camera.project(point) : Eigen::Vector2d::Zero();
        corners[i] = {pixel.x(), pixel.y(), point.z() > kNearest ? 1 / point.z() : -1};
    }
    DepthMap map{camera.height, camera.width, {}};
    map.depth.assign(static_cast<std::size_t>(map.rows) * static_cast<std::size_t>(map.cols),
                     std::numeric_limits<float>::infinity());
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        std::array<Corner, 4> quad{};
        for (Eigen::Index k = 0; k < 4; ++k) {
            quad[static_cast<std::size_t>(k)] = corners[static_cast<std::size_t>(faces(f, k))];
        }
        if (std::all_of(quad.begin(), quad.end(),
                        [](const Corner& corner) { return corner.inverse_z > 0; })) {
            fill_triangle({quad[0], quad[1], quad[2]}, map);
            fill_triangle({quad[0], quad[2], quad[3]}, map);
        }
    }
    return map;
}

}  // namespace mimetic
