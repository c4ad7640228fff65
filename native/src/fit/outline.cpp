// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/outline.hpp"

#include <Eigen/Geometry>

namespace mimetic::fit {
namespace {

constexpr double kCrest = 0.36;  // tangent of the elevation from which the chin has an outline: 20 degrees

Points vertex_normals(const FaceModel& model, const Points& points) {
    Points normals = Points::Zero(points.rows(), 3);
    for (int f = 0; f < model.faces.rows(); ++f) {
        const auto quad = model.faces.row(f);
        const Eigen::Vector3d a = points.row(quad(2)) - points.row(quad(0));
        const Eigen::Vector3d b = points.row(quad(3)) - points.row(quad(1));
        const Eigen::RowVector3d normal = a.cross(b).transpose();
        for (int k = 0; k < 4; ++k) normals.row(quad(k)) += normal;
    }
    normals.rowwise().normalize();
    return normals;
}

}  // namespace

std::vector<EdgePoint> outline(const FaceModel& model, const Points& points,
                               const Eigen::Isometry3d& camera_from_head, const Camera& camera) {
    const Points normals = vertex_normals(model, points);
    Eigen::VectorXd facing(points.rows());
    const Eigen::Vector3d eye = camera_from_head.inverse().translation();
    for (int i = 0; i < points.rows(); ++i) {
        Eigen::RowVector3d to_eye = eye.transpose() - points.row(i);
        // The chin runs into the neck without an outline unless seen from above; what a level look or one
        // from below shows there is the jaw's crest
        to_eye.y() = std::max(to_eye.y(), kCrest * std::hypot(to_eye.x(), to_eye.z()));
        facing(i) = normals.row(i).dot(to_eye.normalized());
    }
    std::vector<EdgePoint> found;
    for (int f = 0; f < model.faces.rows(); ++f) {
        for (int k = 0; k < 4; ++k) {
            const int a = model.faces(f, k);
            const int b = model.faces(f, (k + 1) % 4);
            // An inner edge is met from both its faces, in opposite directions: take it once
            if (facing(a) <= 0 || facing(b) > 0) continue;
            if (!model.on_outline[static_cast<std::size_t>(a)] ||
                !model.on_outline[static_cast<std::size_t>(b)]) {
                continue;
            }
            EdgePoint point{a, b, facing(a) / (facing(a) - facing(b)), {}, {}};
            const Eigen::Vector3d in_camera =
                camera_from_head *
                Eigen::Vector3d((1 - point.fraction) * points.row(a) + point.fraction * points.row(b));
            if (in_camera.z() <= 1e-3) continue;
            point.pixel = camera.project(in_camera);
            const Eigen::Vector3d normal =
                camera_from_head.linear() *
                Eigen::Vector3d((1 - point.fraction) * normals.row(a) + point.fraction * normals.row(b));
            point.normal = normal.head<2>().normalized();
            found.push_back(point);
        }
    }
    return found;
}

Points2 jaw_line(const std::vector<EdgePoint>& points, const Eigen::Vector2d& center, double from_angle,
                 double to_angle, int count) {
    std::vector<double> radius(static_cast<std::size_t>(count), 0);
    const double step = (to_angle - from_angle) / (count - 1);
    const double reach = 0.7 * std::abs(step);
    for (const auto& point : points) {
        const Eigen::Vector2d ray = point.pixel - center;
        if (ray.dot(point.normal) <= 0) continue;
        const double angle = std::atan2(ray.y(), ray.x());
        for (int i = 0; i < count; ++i) {
            const double target = from_angle + i * step;
            if (std::abs(std::remainder(angle - target, 2 * M_PI)) < reach) {
                auto& outer = radius[static_cast<std::size_t>(i)];
                outer = std::max(outer, ray.norm());
            }
        }
    }
    std::vector<Eigen::Vector2d> line;
    for (int i = 0; i < count; ++i) {
        const double r = radius[static_cast<std::size_t>(i)];
        const double target = from_angle + i * step;
        if (r > 0) line.emplace_back(center + r * Eigen::Vector2d(std::cos(target), std::sin(target)));
    }
    Points2 out(static_cast<int>(line.size()), 2);
    for (int i = 0; i < out.rows(); ++i) out.row(i) = line[static_cast<std::size_t>(i)];
    // Sectors take the outermost of several vertices: smooth the stairs that this leaves
    for (int pass = 0; pass < 2; ++pass) {
        const Points2 rough = out;
        for (int i = 1; i + 1 < out.rows(); ++i) {
            out.row(i) = 0.25 * rough.row(i - 1) + 0.5 * rough.row(i) + 0.25 * rough.row(i + 1);
        }
    }
    return out;
}

}  // namespace mimetic::fit
