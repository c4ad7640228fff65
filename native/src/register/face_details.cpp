// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_details.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <mimetic/surface/nearest.hpp>

#include "shared/robust.hpp"
#include "view_camera.hpp"

namespace mimetic {
namespace {

constexpr int kCloseSize = 240;                           // pixels of a side
constexpr double kEyeWidths = 2.5;                        // that a picture of an eye shows
constexpr double kLeastOpening = .4, kMostOpening = 1.8;  // of the width expected
constexpr double kBehind = .5;                            // of its width, behind an eye
constexpr double kPeakReach = .012;                       // m
constexpr double kPeakHeight = 2e-4;                      // m below the foremost point that count as it
const Eigen::Vector3d kLamp = Eigen::Vector3d::UnitZ();

ShadedView close_view(const ShownHead& head, const Eigen::Vector3d& middle, double height) {
    return {head, Eigen::Matrix3d::Identity(), middle, height, kCloseSize, kLamp};
}

/// Cosine between a triangle's normal and z, which points at the viewer.
double facing_viewer(const ShadedMesh& mesh, Eigen::Index triangle) {
    const Eigen::Vector3d a = mesh.vertices.row(mesh.triangles(triangle, 0)),
                          b = mesh.vertices.row(mesh.triangles(triangle, 1)),
                          c = mesh.vertices.row(mesh.triangles(triangle, 2));
    return (b - a).cross(c - a).normalized().z();
}

/// Pixels connected with the first, by their sides, of those that hold; none if it does not.
std::vector<std::size_t> connected(const std::vector<bool>& holds, std::size_t first, int size) {
    std::vector<bool> is_taken(holds.size());
    std::vector<std::size_t> pixels;
    const auto take = [&](std::size_t at) {
        if (holds[at] && !is_taken[at]) {
            is_taken[at] = true;
            pixels.push_back(at);
        }
    };
    take(first);
    const auto side = static_cast<std::size_t>(size);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::size_t at = pixels[i];
        if (at % side > 0) take(at - 1);
        if (at % side + 1 < side) take(at + 1);
        if (at >= side) take(at - side);
        if (at + side < holds.size()) take(at + side);
    }
    return pixels;
}

}  // namespace

int skin_part(const ShownHead& head, const Points& places) {
    const ShadedView view(head, Eigen::Matrix3d::Identity(), kFaceMiddle, kFaceHeight, kViewSize, kLamp);
    std::map<int, int> votes;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const Eigen::Vector2d pixel = view.pixel(places.row(i).transpose());
        if (!(pixel.minCoeff() >= 0 && pixel.maxCoeff() < kViewSize - 1)) {
            continue;
        }
        const int triangle = view.shaded.raster.face[view.shaded.raster.index(
            static_cast<int>(pixel.x() + .5), static_cast<int>(pixel.y() + .5))];
        if (triangle >= 0) {
            ++votes[head.part[static_cast<std::size_t>(triangle)]];
        }
    }
    int skin = -1, most = 0;
    for (const auto& [part, count] : votes) {
        if (count > most) {
            skin = part;
            most = count;
        }
    }
    return skin;
}

Eigen::Vector2d EyeOpening::share_of(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d along = outer - inner, offset = place - inner;
    return Eigen::Vector2d(along.dot(offset), along.x() * offset.y() - along.y() * offset.x()) /
           along.squaredNorm();
}

Eigen::Vector2d EyeOpening::place_of(const Eigen::Vector2d& share) const {
    const Eigen::Vector2d along = outer - inner;
    return inner + share.x() * along + share.y() * Eigen::Vector2d(-along.y(), along.x());
}

std::optional<EyeOpening> eye_opening(const ShownHead& head, int skin, const Eigen::Vector3d& inner,
                                      const Eigen::Vector3d& outer) {
    const double width = (outer - inner).norm();
    if (!(width > 1e-3)) {
        return std::nullopt;
    }
    const ShadedView view = close_view(head, (inner + outer) / 2, kEyeWidths * width);
    const Raster& raster = view.shaded.raster;
    std::vector<bool> is_open(raster.face.size());
    const auto behind = static_cast<float>(view.distance + kBehind * width);
    for (std::size_t i = 0; i < is_open.size(); ++i) {
        const int triangle = raster.face[i];
        // Through an eye without an eyeball one sees the inside of the head, far behind: a fold's is near
        is_open[i] = triangle < 0 || head.part[static_cast<std::size_t>(triangle)] != skin ||
                     (facing_viewer(view.head, triangle) < 0 && raster.depth[i] > behind);
    }
    // From the middle, or what is open next to it above or below: a lid may hang there
    std::size_t first = raster.index(kCloseSize / 2, kCloseSize / 2);
    for (int step = 1; !is_open[first] && step < kCloseSize / 8; ++step) {
        for (const int sign : {-1, 1}) {
            const std::size_t at = raster.index(kCloseSize / 2, kCloseSize / 2 + sign * step);
            first = is_open[at] ? at : first;
        }
    }
    const Eigen::Vector2d along = (outer - inner).head<2>().normalized();
    EyeOpening opening;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::size_t at : connected(is_open, first, kCloseSize)) {
        const auto x = static_cast<int>(at) % kCloseSize, y = static_cast<int>(at) / kCloseSize;
        if (x == 0 || y == 0 || x == kCloseSize - 1 || y == kCloseSize - 1) {
            return std::nullopt;  // no opening of its own: it runs out of the picture
        }
        const Eigen::Vector3d ray = view.camera.ray(x, y) * view.distance;
        const Eigen::Vector2d place = Eigen::Vector2d(ray.x(), -ray.y()) + view.middle.head<2>();
        if (place.dot(along) < low) {
            low = place.dot(along);
            opening.inner = place;
        }
        if (place.dot(along) > high) {
            high = place.dot(along);
            opening.outer = place;
        }
    }
    if (!(high - low > kLeastOpening * width && high - low < kMostOpening * width)) {
        return std::nullopt;
    }
    return opening;
}

std::optional<Peak> foremost(const ShownHead& head, const Eigen::Vector3d& near) {
    const ShadedView view = close_view(head, near, 3 * kPeakReach);
    std::vector<Eigen::Vector3d> places;
    double front = -std::numeric_limits<double>::infinity();
    for (int y = 0; y < kCloseSize; ++y) {
        for (int x = 0; x < kCloseSize; ++x) {
            const Eigen::Vector3d place = view.point({x, y});
            if ((place - near).norm() < kPeakReach) {
                places.push_back(place);
                front = std::max(front, place.z());
            }
        }
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (const Eigen::Vector3d& place : places) {
        const double weight = std::exp((place.z() - front) / kPeakHeight);
        sum += weight * place;
        weights += weight;
    }
    if (places.empty() || !((sum / weights - near).head<2>().norm() < .8 * kPeakReach)) {
        return std::nullopt;
    }
    std::vector<double> heights;
    heights.reserve(places.size());
    for (const Eigen::Vector3d& place : places) {
        heights.push_back(place.z());
    }
    return Peak{sum / weights, front - median(heights)};
}

std::optional<Eigen::Vector3d> skin_at(const ShownHead& head, int skin, const Eigen::Vector2d& place) {
    std::optional<Eigen::Vector3d> nearest;
    const ShadedMesh& mesh = head.mesh;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        if (head.part[static_cast<std::size_t>(t)] != skin || !(facing_viewer(mesh, t) > 0)) {
            continue;
        }
        TriangleCorners<double> corners;
        Eigen::Vector3d depths, weights;
        for (Eigen::Index k = 0; k < 3; ++k) {
            corners[static_cast<std::size_t>(k)] =
                mesh.vertices.row(mesh.triangles(t, k)).head<2>().transpose();
            depths[k] = mesh.vertices(mesh.triangles(t, k), 2);
        }
        if (!barycentric_of<double>(place, corners, weights) || weights.minCoeff() < 0) {
            continue;
        }
        const double z = weights.dot(depths);
        if (!nearest || z > nearest->z()) {
            nearest = Eigen::Vector3d(place.x(), place.y(), z);
        }
    }
    return nearest;
}

Points on_shown_surface(const ShownHead& head, const Points& points) {
    Points moved = points;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::Vector3d point = points.row(i).transpose();
        double least = std::numeric_limits<double>::infinity();
        for (const double yaw : {0., -.7, .7}) {
            const ShadedView view(head, Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                                  point, .03, kCloseSize / 2, kLamp);
            for (int y = 0; y < kCloseSize / 2; ++y) {
                for (int x = 0; x < kCloseSize / 2; ++x) {
                    const Eigen::Vector3d place = view.point({x, y});
                    const double gap = (place - point).norm();
                    if (gap < least) {
                        least = gap;
                        moved.row(i) = place.transpose();
                    }
                }
            }
        }
    }
    return moved;
}

}  // namespace mimetic
