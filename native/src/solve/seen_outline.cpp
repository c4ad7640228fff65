// SPDX-License-Identifier: GPL-3.0-or-later
#include "seen_outline.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/raster/shaded.hpp>
#include <optional>

#include "shared/colour_at.hpp"

namespace mimetic {

namespace {

constexpr float kMeasured = .5f;       // weight from which a vertex is of the face
constexpr double kReach = .010;        // metres to both sides in which the edge is looked for
constexpr double kLeastReach = 5;      // pixels
constexpr double kApart = .008;        // metres between two points
constexpr double kNear = .003;         // metres inside of the outline: there the face itself is seen
constexpr double kSameDepth = .03;     // metres
constexpr double kLeastContrast = 30;  // grey levels between the two sides, all three channels together
constexpr double kLeastError = 1e-3;   // metres: what the outline is of, hair and beard included
constexpr double kHighest = .02;       // metres above the head's origin: beyond, hair has the outline
constexpr double kStep = .5;           // pixels

struct ContourPoint {
    Eigen::RowVector3i vertices;
    Eigen::RowVector3d barycentric;
    Eigen::Vector3d place;   // head frame, metres
    Eigen::Vector2d pixel;   // where the surface has it
    Eigen::Vector2d normal;  // image direction out of the face, unit
    double depth;            // metres
};

struct Edge {
    double offset;  // pixels along the normal
    double std;
};

/// The middle of the line on which a triangle's interpolated normal is square to the line of sight.
std::optional<Eigen::RowVector3d> crossing(const Eigen::Vector3d& facing) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    int num_edges = 0;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if ((facing[k] > 0) != (facing[next] > 0)) {
            const double share = facing[k] / (facing[k] - facing[next]);
            middle[k] += .5 * (1 - share);
            middle[next] += .5 * share;
            ++num_edges;
        }
    }
    return num_edges == 2 ? std::optional(middle) : std::nullopt;
}

std::vector<ContourPoint> contour(const FaceSurface& surface, const ProjectedSurface& projected,
                                  const Camera& camera, const Eigen::Isometry3d& camera_from_head) {
    const Points points = projected.points_in_head.cast<double>();
    const Points normals = vertex_normals(points, surface.triangles());
    const Eigen::RowVector3d eye = camera_from_head.inverse().translation().transpose();
    std::vector<ContourPoint> found;
    for (Eigen::Index t = 0; t < surface.triangles().rows(); ++t) {
        const Eigen::RowVector3i corners = surface.triangles().row(t);
        Eigen::Vector3d facing;
        bool is_measured = true;
        for (int k = 0; k < 3; ++k) {
            is_measured &= surface.weights()[corners[k]] >= kMeasured && projected.depths[corners[k]] > 0;
            facing[k] = normals.row(corners[k]).dot((eye - points.row(corners[k])).normalized());
        }
        const auto middle = is_measured ? crossing(facing) : std::nullopt;
        if (!middle) {
            continue;
        }
        ContourPoint point{corners, *middle, Eigen::Vector3d::Zero(), {}, {}, 0};
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
            point.place += (*middle)[k] * points.row(corners[k]).transpose();
            normal += (*middle)[k] * normals.row(corners[k]).transpose();
        }
        if (point.place.y() > kHighest) {
            continue;
        }
        const Eigen::Vector3d in_camera = camera_from_head * point.place;
        point.pixel = camera.project(in_camera);
        point.depth = in_camera.z();
        point.normal = (camera_from_head.linear() * normal).head<2>().normalized();
        found.push_back(point);
    }
    return found;
}

/// The drawn surface in the frame's pixels: which of the points are before nothing but what is behind the
/// head.
class Silhouette {
public:
    Silhouette(const FaceSurface& surface, const ProjectedSurface& projected, const Camera& camera) {
        raster_surface(projected, surface.triangles(),
                       {Eigen::Vector2d::Zero(), 1, camera.height, camera.width}, raster_);
    }

    bool is_outermost(const ContourPoint& point, double near, double reach) const {
        const auto inside = depth_at(point.pixel - near * point.normal);
        if (!inside || std::abs(*inside - point.depth) > kSameDepth) {
            return false;
        }
        for (double away = near; away <= reach; away += 1) {
            const Eigen::Vector2d pixel = point.pixel + away * point.normal;
            if (!is_inside(pixel) || depth_at(pixel)) {
                return false;
            }
        }
        return is_inside(point.pixel - reach * point.normal);
    }

private:
    bool is_inside(const Eigen::Vector2d& pixel) const {
        return pixel.minCoeff() >= 1 && pixel.x() < raster_.cols - 2 && pixel.y() < raster_.rows - 2;
    }

    /// Of the skin that a pixel shows; nothing where it shows none.
    std::optional<double> depth_at(const Eigen::Vector2d& pixel) const {
        if (!is_inside(pixel)) {
            return {};
        }
        const std::size_t at =
            raster_.index(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
        return raster_.face[at] < 0 ? std::nullopt : std::optional<double>(raster_.depth[at]);
    }

    Raster raster_;
};

/// Where one edge parts the colours inside from those outside; nothing where there is none, or several.
std::optional<Edge> find_edge(const ColorView& image, const ContourPoint& point, double reach) {
    const Eigen::Vector2d across(-point.normal.y(), point.normal.x());
    const int half = static_cast<int>(reach / kStep);
    std::vector<Eigen::Vector3d> colours;
    for (int i = -half; i <= half; ++i) {
        const Eigen::Vector2d pixel = point.pixel + i * kStep * point.normal;
        colours.push_back(
            (colour_at(image, pixel - across) + colour_at(image, pixel) + colour_at(image, pixel + across)) /
            3);
    }
    const int side = half / 2;  // samples at either end that are surely of one side
    Eigen::Vector3d inside = Eigen::Vector3d::Zero(), outside = Eigen::Vector3d::Zero();
    for (int i = 0; i < side; ++i) {
        inside += colours[static_cast<std::size_t>(i)] / side;
        outside += colours[colours.size() - 1 - static_cast<std::size_t>(i)] / side;
    }
    const Eigen::Vector3d change = outside - inside;
    if (change.norm() < kLeastContrast) {
        return {};
    }
    constexpr double kLow = .25, kHigh = .75;
    int last_inside = -1, first_outside = static_cast<int>(colours.size());
    std::vector<double> shares;
    for (std::size_t i = 0; i < colours.size(); ++i) {
        shares.push_back((colours[i] - inside).dot(change) / change.squaredNorm());
        const int at = static_cast<int>(i);
        last_inside = shares[i] < kLow ? at : last_inside;
        first_outside = shares[i] > kHigh ? std::min(first_outside, at) : first_outside;
    }
    if (last_inside < 0 || first_outside <= last_inside) {
        return {};
    }
    for (int at = last_inside; at < first_outside; ++at) {
        const double here = shares[static_cast<std::size_t>(at)];
        const double next = shares[static_cast<std::size_t>(at) + 1];
        if (here <= .5 && next > .5) {
            const double offset = (at + (.5 - here) / (next - here) - half) * kStep;
            return Edge{offset, std::max(kStep, (first_outside - last_inside) * kStep / 3)};
        }
    }
    return {};
}

}  // namespace

SkinObservations seen_outline(const FaceSurface& surface, const Camera& camera, const FaceState& state,
                              const ColorView& image) {
    ProjectedSurface projected;
    projected.update(surface, camera, state.camera_from_head, state.values);
    const Silhouette silhouette(surface, projected, camera);
    std::vector<ContourPoint> kept;
    std::vector<Edge> edges;
    for (const ContourPoint& point : contour(surface, projected, camera, state.camera_from_head)) {
        const double scale = camera.fx / point.depth;  // pixels a metre
        const double reach = std::max(kLeastReach, kReach * scale);
        const bool is_apart = std::all_of(kept.begin(), kept.end(), [&](const ContourPoint& other) {
            return (other.place - point.place).norm() > kApart;
        });
        if (!is_apart || !silhouette.is_outermost(point, std::max(1.5, kNear * scale), reach)) {
            continue;
        }
        if (const auto edge = find_edge(image, point, reach)) {
            kept.push_back(point);
            edges.push_back({edge->offset, std::hypot(edge->std, kLeastError * scale)});
        }
    }
    const auto count = static_cast<Eigen::Index>(kept.size());
    SkinObservations seen{Triangles(count, 3), Points(count, 3), Rows<double, 2>(count, 2),
                          Rows<double, 4>(count, 4)};
    for (Eigen::Index k = 0; k < count; ++k) {
        const ContourPoint& point = kept[static_cast<std::size_t>(k)];
        const Edge& edge = edges[static_cast<std::size_t>(k)];
        seen.vertices.row(k) = point.vertices;
        seen.barycentric.row(k) = point.barycentric;
        seen.pixels.row(k) = point.pixel + edge.offset * point.normal;
        const Eigen::Matrix2d information = point.normal * point.normal.transpose() / (edge.std * edge.std);
        seen.information.row(k) << information(0, 0), information(0, 1), information(1, 0), information(1, 1);
    }
    return seen;
}

}  // namespace mimetic
