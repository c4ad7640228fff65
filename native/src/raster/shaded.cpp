// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>

namespace mimetic {
namespace {

constexpr double kAmbient = .35;
constexpr std::uint8_t kGround = 60;
constexpr double kNearest = 1e-3;  // metres

void check_mesh(const ShadedMesh& mesh) {
    if (mesh.normals.rows() != mesh.vertices.rows() || mesh.colours.rows() != mesh.triangles.rows()) {
        throw InvalidInput("a shaded mesh needs a normal for each vertex and a colour for each triangle");
    }
    if (!mesh.vertices.allFinite()) {
        throw InvalidInput("a vertex of the mesh is not finite");
    }
    if (mesh.triangles.size() > 0 &&
        (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.vertices.rows())) {
        throw InvalidInput("a triangle names a vertex that the mesh does not have");
    }
}

}  // namespace

Eigen::Vector3d across_view(const Eigen::Vector3d& point, double distance) {
    return {point.x(), -point.y(), distance - point.z()};
}

Points area_normals(PointsIn vertices, TrianglesIn triangles) {
    Points normals = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                              c = vertices.row(triangles(t, 2));
        const Eigen::RowVector3d normal = (b - a).cross(c - a).transpose();
        for (Eigen::Index k = 0; k < 3; ++k) {
            normals.row(triangles(t, k)) += normal;
        }
    }
    return normals;
}

Points vertex_normals(PointsIn vertices, TrianglesIn triangles) {
    Points normals = area_normals(vertices, triangles);
    for (Eigen::Index v = 0; v < normals.rows(); ++v) {
        const double length = normals.row(v).norm();
        if (length > 0) {
            normals.row(v) /= length;
        }
    }
    return normals;
}

ShadedPicture draw_shaded(const Camera& camera, const ShadedMesh& mesh, double distance,
                          const Eigen::Vector3d& light) {
    check_mesh(mesh);
    camera.check();
    ShadedPicture shaded{{camera.height, camera.width, {}}, Raster(camera.height, camera.width)};
    shaded.picture.pixels.assign(3 * shaded.raster.face.size(), kGround);
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        TriangleCorners<double> corners;
        Eigen::Vector3d nearness, shades;
        bool is_before = true;
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int v = mesh.triangles(t, k);
            const Eigen::Vector3d point = across_view(mesh.vertices.row(v).transpose(), distance);
            is_before = is_before && point.z() > kNearest;
            corners[static_cast<std::size_t>(k)] = camera.project(point);
            nearness[k] = 1 / point.z();
            const Eigen::Vector3d normal = mesh.normals.row(v).transpose();
            const double side = normal.dot(Eigen::Vector3d(-point.x(), point.y(), point.z())) < 0 ? -1 : 1;
            shades[k] = side * normal.dot(light);
        }
        if (!is_before) {
            continue;
        }
        fill_triangle(
            corners, camera.height, camera.width, [&](int x, int y, const Eigen::Vector3d& weights) {
                const double depth = 1 / weights.dot(nearness);
                if (!shaded.raster.keep_nearer(x, y, static_cast<int>(t), static_cast<float>(depth))) {
                    return;
                }
                const double shade = kAmbient + (1 - kAmbient) * std::clamp(weights.dot(shades), 0., 1.);
                std::uint8_t* pixel = shaded.picture.pixels.data() + 3 * shaded.raster.index(x, y);
                for (Eigen::Index k = 0; k < 3; ++k) {
                    pixel[k] = static_cast<std::uint8_t>(
                        std::lround(std::clamp(shade * mesh.colours(t, k), 0., 255.)));
                }
            });
    }
    return shaded;
}

Eigen::Vector3d shown_point(const Camera& camera, const ShadedMesh& mesh, double distance,
                            const Raster& raster, const Eigen::Vector2d& pixel) {
    Eigen::Vector3d nowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (!(pixel.minCoeff() > -.5) || !(pixel.x() < raster.cols - .5) || !(pixel.y() < raster.rows - .5)) {
        return nowhere;
    }
    const std::size_t at = raster.index(static_cast<int>(pixel.x() + .5), static_cast<int>(pixel.y() + .5));
    const int triangle = raster.face[at];
    if (triangle < 0) {
        return nowhere;
    }
    Eigen::Matrix3d corners;
    for (Eigen::Index k = 0; k < 3; ++k) {
        corners.col(k) = across_view(mesh.vertices.row(mesh.triangles(triangle, k)).transpose(), distance);
    }
    const Eigen::Vector3d ray = camera.ray(pixel.x(), pixel.y());
    const Eigen::Vector3d normal = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    double depth = normal.dot(corners.col(0)) / normal.dot(ray);
    const double low = corners.row(2).minCoeff(), high = corners.row(2).maxCoeff();
    depth = std::isfinite(depth) ? std::clamp(depth, low, high) : static_cast<double>(raster.depth[at]);
    return across_view(depth * ray, distance);
}

}  // namespace mimetic
