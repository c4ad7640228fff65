// SPDX-License-Identifier: GPL-3.0-or-later
#include "seen_head.hpp"

#include <mimetic/raster/depth.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "shared/gray.hpp"

namespace mimetic::head {
namespace {

constexpr int kSmallestCrop = 64;  // pixels

cv::Vec3f to_vec(const Eigen::Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Distance along a ray (origin, direction in the head frame) and the normal there; 0: misses the model.
double meet_ellipsoid(const HeadShape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                      Eigen::Vector3d& normal) {
    const Eigen::Matrix3d to_axes = shape.turn.transpose();
    const Eigen::Vector3d from = (to_axes * (origin - shape.centre)).cwiseQuotient(shape.half_axes);
    const Eigen::Vector3d along = (to_axes * ray).cwiseQuotient(shape.half_axes);
    const double a = along.squaredNorm(), b = along.dot(from), c = from.squaredNorm() - 1;
    const double root = b * b - a * c;
    if (root < 0) {
        return 0;
    }
    const double distance = (-b - std::sqrt(root)) / a;
    normal = shape.turn * (from + distance * along).cwiseQuotient(shape.half_axes).normalized();
    return distance;
}

double meet_plane(const HeadShape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                  Eigen::Vector3d& normal) {
    if (ray.z() > -1e-6) {
        return 0;
    }
    const double distance = (shape.centre.z() - origin.z()) / ray.z();
    const Eigen::Vector2d place = (origin + distance * ray - shape.centre).head<2>();
    normal = Eigen::Vector3d::UnitZ();
    return place.cwiseQuotient(shape.half_axes.head<2>()).squaredNorm() <= 1 ? distance : 0;
}

void see_surface(const HeadShape& shape, const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                 SeenHead& seen) {
    Points moved = (shape.vertices * camera_from_head.linear().transpose()).rowwise() +
                   camera_from_head.translation().transpose();
    const DepthMap map = render_depth(camera, moved, shape.faces);
    const auto at = [&](int x, int y) -> Eigen::Vector3d {
        return camera.ray(x, y) * double{map.depth[map.index(x, y)]};
    };
    constexpr double kStep = 0.03;  // metres between neighbours of one skin
    const Eigen::Isometry3d head_from_camera = camera_from_head.inverse();
    for (int y = 1; y + 1 < map.rows; ++y) {
        for (int x = 1; x + 1 < map.cols; ++x) {
            const Eigen::Vector3d point = at(x, y);
            const Eigen::Vector3d across = at(x + 1, y) - at(x - 1, y);
            const Eigen::Vector3d along = at(x, y + 1) - at(x, y - 1);
            if (!(std::abs(across.z()) < kStep && std::abs(along.z()) < kStep) || !point.allFinite()) {
                continue;
            }
            const Eigen::Vector3d normal = along.cross(across).normalized();
            seen.points(y, x) = to_vec(head_from_camera * point);
            seen.normals(y, x) = to_vec(head_from_camera.linear() * normal);
            seen.facing(y, x) = static_cast<float>(std::max(0., -normal.dot(point.normalized())));
        }
    }
}

}  // namespace

SeenHead see_head(const HeadShape& shape, const Camera& camera, const Eigen::Isometry3d& camera_from_head) {
    SeenHead seen{cv::Mat3f::zeros(camera.height, camera.width),
                  cv::Mat3f::zeros(camera.height, camera.width),
                  cv::Mat1f::zeros(camera.height, camera.width)};
    if (shape.model == HeadModel::surface) {
        see_surface(shape, camera, camera_from_head, seen);
        return seen;
    }
    const Eigen::Matrix3d turn = camera_from_head.linear().transpose();
    const Eigen::Vector3d origin = -turn * camera_from_head.translation();
    const auto meet = shape.model == HeadModel::plane ? meet_plane : meet_ellipsoid;
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const Eigen::Vector3d ray = turn * camera.ray(x, y).normalized();
            Eigen::Vector3d normal;
            const double distance = meet(shape, origin, ray, normal);
            if (distance > 0) {
                seen.points(y, x) = to_vec(origin + distance * ray);
                seen.normals(y, x) = to_vec(normal);
                seen.facing(y, x) = static_cast<float>(std::max(0., -normal.dot(ray)));
            }
        }
    }
    return seen;
}

double rigidity(const HeadShape& shape, const Eigen::Vector3d& point_in_head) {
    double weight = 1;
    for (const MovingPart& part : shape.moving_parts) {
        const double distance = (point_in_head.head<2>() - part.centre).norm() / part.radius;
        weight *= point_in_head.z() > 0 ? 1 - part.share * std::exp(-.5 * distance * distance) : 1;
    }
    return weight;
}

Camera thin_camera(const Camera& camera, int spacing) {
    const int first = spacing / 2;
    return {camera.fx / spacing,
            camera.fy / spacing,
            (camera.cx - first) / spacing,
            (camera.cy - first) / spacing,
            (camera.width - first - 1) / spacing + 1,
            (camera.height - first - 1) / spacing + 1};
}

std::optional<Camera> crop_camera(const HeadShape& shape, const Camera& camera,
                                  const Eigen::Isometry3d& camera_from_head, int crop_height, double margin) {
    Eigen::AlignedBox3d body;
    if (shape.model == HeadModel::surface) {
        body = Eigen::AlignedBox3d(Eigen::Vector3d(shape.vertices.colwise().minCoeff()),
                                   Eigen::Vector3d(shape.vertices.colwise().maxCoeff()));
    } else {
        const Eigen::Vector3d reach(shape.half_axes.x(), shape.half_axes.y(),
                                    shape.model == HeadModel::plane ? 0 : shape.half_axes.z());
        body = Eigen::AlignedBox3d(shape.centre - reach, shape.centre + reach);
    }
    // A rounded body touches its box in the middles of the box's sides.
    Eigen::AlignedBox2d box;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-.5, .5}) {
            const Eigen::Vector3d point =
                camera_from_head *
                Eigen::Vector3d(body.center() + side * body.sizes()[axis] * shape.turn.col(axis));
            if (point.z() < .05) {
                return {};
            }
            box.extend(camera.project(point));
        }
    }
    const Eigen::Vector2d beyond = margin * box.sizes();
    const int left = std::max(0, static_cast<int>(std::floor(box.min().x() - beyond.x())));
    const int top = std::max(0, static_cast<int>(std::floor(box.min().y() - beyond.y())));
    const int right = std::min(camera.width, static_cast<int>(std::ceil(box.max().x() + beyond.x())) + 1);
    const int bottom = std::min(camera.height, static_cast<int>(std::ceil(box.max().y() + beyond.y())) + 1);
    const double least = kSmallestCrop / double(std::max(1, std::min(right - left, bottom - top)));
    const double wanted = std::min(1., std::max(least, crop_height / box.sizes().maxCoeff()));
    const int cols = static_cast<int>((right - left) * wanted + 1e-6);
    const int rows = static_cast<int>((bottom - top) * wanted + 1e-6);
    if (right <= left || bottom <= top || cols < kSmallestCrop || rows < kSmallestCrop) {
        return {};
    }
    const double across = cols / double(right - left), along = rows / double(bottom - top);
    return Camera{camera.fx * across,
                  camera.fy * along,
                  (camera.cx - left + .5) * across - .5,
                  (camera.cy - top + .5) * along - .5,
                  cols,
                  rows};
}

cv::Mat1b gray_frame(const ColorView& image, const Camera& camera) {
    if (image.rows != camera.height || image.cols != camera.width) {
        throw InvalidInput("the frame is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " pixels, the camera " + std::to_string(camera.width) + " x " +
                           std::to_string(camera.height));
    }
    return to_gray(image);
}

HeadCrop cut(const cv::Mat1b& frame, const Camera& camera, const Camera& part) {
    const double across = part.fx / camera.fx, along = part.fy / camera.fy;
    const int left = static_cast<int>(std::lround(camera.cx + .5 - (part.cx + .5) / across));
    const int top = static_cast<int>(std::lround(camera.cy + .5 - (part.cy + .5) / along));
    const int width = static_cast<int>(std::lround(part.width / across));
    const int height = static_cast<int>(std::lround(part.height / along));
    HeadCrop crop{part, {}, std::sqrt(across * along)};
    cv::resize(frame(cv::Rect(left, top, width, height)), crop.gray, {part.width, part.height}, 0, 0,
               cv::INTER_AREA);
    return crop;
}

}  // namespace mimetic::head
