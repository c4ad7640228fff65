// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/raster/depth.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/surface/places.hpp>
#include <numbers>
#include <numeric>

#include "shared/robust.hpp"

namespace mimetic {
namespace {

constexpr double kSteep = .2;    // cosine of normal and view below which a ray's intersection is unreliable
constexpr double kReach = 5e-3;  // metres beside the ray, as seen, within which facing skin is looked for
constexpr double kBehind =
    3e-3;  // metres deeper than facing skin beside it allows: hidden, were the outline right
constexpr double kLeastFacing = .1;  // cosine under which skin counts as turned away
constexpr double kOutline = .15;  // cosine below which the outline's error decides where a ray meets the skin
constexpr double kOutlineError = 1.5e-3;  // metres, of a fit, in the picture
constexpr double kNearest = 1e-3;         // metres
const double kSteepest =
    std::sqrt(1 / (kSteep * kSteep) - 1);  // depth over breadth of skin that is just not steep

/// A surface in front of the camera, and its vertices that are visible and not oblique.
struct View {
    const Camera& camera;
    PointsIn vertices;
    Triangles triangles;
    std::vector<int> facing;                ///< vertices
    std::vector<int> owner;                 ///< a triangle that has each
    std::vector<Eigen::Vector2d> shown_at;  ///< pixels; all three in the order of shown_at.x

    Eigen::Vector3d at(int triangle, const Eigen::RowVector3d& weights) const {
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int corner = 0; corner < 3; ++corner) {
            place += weights[corner] * vertices.row(triangles(triangle, corner)).transpose();
        }
        return place;
    }
    double cosine(int triangle, const Eigen::Vector3d& place) const {
        return facing_cosine(vertices, triangles.row(triangle), place);
    }
};

void find_facing(View& view, QuadsIn faces) {
    std::vector<int> owner(static_cast<std::size_t>(view.vertices.rows()), -1);
    std::vector<bool> is_steep(owner.size(), false), is_flat;
    for (Eigen::Index t = 0; t < view.triangles.rows(); ++t) {
        const Eigen::Vector3d first = view.vertices.row(view.triangles(t, 0));
        is_flat.push_back(facing_cosine(view.vertices, view.triangles.row(t), first) >= kSteep);
    }
    for (int corner = 0; corner < 3; ++corner) {
        for (Eigen::Index t = 0; t < view.triangles.rows(); ++t) {
            const auto vertex = static_cast<std::size_t>(view.triangles(t, corner));
            if (is_flat[static_cast<std::size_t>(t)]) {
                owner[vertex] = static_cast<int>(t);
            } else {
                is_steep[vertex] = true;
            }
        }
    }
    const DepthMap depth = render_depth(view.camera, view.vertices, faces);
    std::vector<std::pair<double, int>> facing;  // x, vertex
    for (std::size_t v = 0; v < owner.size(); ++v) {
        const Eigen::Vector3d point = view.vertices.row(static_cast<Eigen::Index>(v));
        if (owner[v] >= 0 && !is_steep[v] && point.z() > kNearest &&
            depth.shows(view.camera, point, kCovered)) {
            facing.emplace_back(view.camera.project(point).x(), static_cast<int>(v));
        }
    }
    std::sort(facing.begin(), facing.end());
    for (const auto& [x, vertex] : facing) {
        view.facing.push_back(vertex);
        view.owner.push_back(owner[static_cast<std::size_t>(vertex)]);
        view.shown_at.push_back(view.camera.project(Eigen::Vector3d(view.vertices.row(vertex))));
    }
}

/// The facing vertex that a pixel shows rather than a place its ray meets; -1: none.
int skin_before(const View& view, const Eigen::Vector2d& pixel, const Eigen::Vector3d& place, bool is_steep) {
    int nearest = -1;
    double least = kReach;
    const double reach_px = kReach * view.camera.fx / place.z();
    const auto left = std::lower_bound(view.shown_at.begin(), view.shown_at.end(), pixel.x() - reach_px,
                                       [](const Eigen::Vector2d& shown, double x) { return shown.x() < x; });
    for (auto i = static_cast<std::size_t>(left - view.shown_at.begin());
         i < view.shown_at.size() && view.shown_at[i].x() <= pixel.x() + reach_px; ++i) {
        const double beside = (view.shown_at[i] - pixel).norm() * place.z() / view.camera.fx;
        if (!(beside < least)) {
            continue;
        }
        const double allowed = is_steep ? 0 : kBehind + kSteepest * beside;
        if (place.z() > view.vertices(view.facing[i], 2) + allowed) {
            nearest = static_cast<int>(i);
            least = beside;
        }
    }
    return nearest;
}

int nearest_shown(const View& view, const Eigen::Vector2d& pixel) {
    const auto nearer = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - pixel).squaredNorm() < (b - pixel).squaredNorm();
    };
    return static_cast<int>(std::min_element(view.shown_at.begin(), view.shown_at.end(), nearer) -
                            view.shown_at.begin());
}

/// Rays about one, pixels, and the share of each under a Gaussian of the standard deviation `error` (pixels).
struct RaysAbout {
    std::vector<Eigen::Vector2d> rays{Eigen::Vector2d::Zero()};
    std::vector<double> shares{1};

    explicit RaysAbout(double error) {
        constexpr int kSpokes = 8;
        for (const double radius : {.6, 1.2, 1.9}) {  // in errors
            for (int spoke = 0; spoke < kSpokes; ++spoke) {
                const double turn = 2 * std::numbers::pi * spoke / kSpokes;
                rays.emplace_back(radius * error * std::cos(turn), radius * error * std::sin(turn));
                shares.push_back(std::max(1., radius) * std::exp(-.5 * radius * radius));
            }
        }
    }
};

/// Of rays about a pixel, the one that meets facing skin in the middle of their depths; -1: none does.
int middle_ray(const View& view, const RayHits& hits, Eigen::Index first, const RaysAbout& about) {
    std::vector<std::pair<double, std::size_t>> met;  // depth, ray
    double total = 0;
    for (std::size_t r = 0; r < about.rays.size(); ++r) {
        const Eigen::Index hit = first + static_cast<Eigen::Index>(r);
        if (hits.triangle[hit] < 0) {
            continue;
        }
        const Eigen::Vector3d place = view.at(hits.triangle[hit], hits.weights.row(hit));
        if (view.cosine(hits.triangle[hit], place) > kLeastFacing) {
            met.emplace_back(place.z(), r);
            total += about.shares[r];
        }
    }
    std::sort(met.begin(), met.end());
    double below = 0;
    for (const auto& [depth, ray] : met) {
        below += about.shares[ray];
        if (below >= total / 2) {
            return static_cast<int>(ray);
        }
    }
    return -1;
}

/// At the outline a ray a pixel beside another may meet skin 2 cm deeper: there the place is that of the
/// middle depth among rays spread as far as the outline errs.
void settle_outline(const View& view, Points2In pixels, SurfacePlaces& places) {
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index k = 0; k < pixels.rows(); ++k) {
        const Eigen::Vector3d place = view.at(places.triangle[k], places.weights.row(k));
        const bool is_moved = (places.offset.row(k).array() != 0).any();
        if (!places.on_face[static_cast<std::size_t>(k)] ||
            (!is_moved && view.cosine(places.triangle[k], place) < kOutline)) {
            chosen.push_back(k);
        }
    }
    if (chosen.empty()) {
        return;
    }
    std::vector<double>
        depths;  // of the face, not of the pixels: a result must not depend on the other pixels
    depths.reserve(view.facing.size());
    for (const int vertex : view.facing) {
        depths.push_back(view.vertices(vertex, 2));
    }
    const RaysAbout about(kOutlineError * view.camera.fx / median(std::move(depths)));
    const auto num_rays = static_cast<Eigen::Index>(about.rays.size());
    Points2 spread(num_rays * static_cast<Eigen::Index>(chosen.size()), 2);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        for (Eigen::Index r = 0; r < num_rays; ++r) {
            spread.row(static_cast<Eigen::Index>(i) * num_rays + r) =
                pixels.row(chosen[i]) + about.rays[static_cast<std::size_t>(r)].transpose();
        }
    }
    const RayHits hits = cast_rays(view.camera, view.vertices, view.triangles, spread);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Eigen::Index first = static_cast<Eigen::Index>(i) * num_rays, k = chosen[i];
        const int ray = middle_ray(view, hits, first, about);
        if (ray >= 0) {
            places.triangle[k] = hits.triangle[first + ray];
            places.weights.row(k) = hits.weights.row(first + ray);
            const Eigen::Vector3d place = view.at(places.triangle[k], places.weights.row(k));
            places.offset.row(k) = pixels.row(k) - view.camera.project(place).transpose();
        }
    }
}

}  // namespace

Triangles triangles_of(QuadsIn quads) {
    Triangles triangles(2 * quads.rows(), 3);
    triangles.topRows(quads.rows()) = quads.leftCols<3>();
    triangles.bottomRows(quads.rows()) << quads.col(0), quads.col(2), quads.col(3);
    return triangles;
}

std::optional<SurfacePlaces> places_under(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces,
                                          Points2In pixels) {
    View view{camera, vertices_in_camera, triangles_of(faces), {}, {}, {}};
    const RayHits hits = cast_rays(camera, vertices_in_camera, view.triangles, pixels);
    find_facing(view, faces);
    if (view.facing.empty()) {
        return std::nullopt;
    }
    SurfacePlaces places{{}, hits.triangle, hits.weights, Points2::Zero(pixels.rows(), 2)};
    for (Eigen::Index k = 0; k < pixels.rows(); ++k) {
        const Eigen::Vector2d pixel = pixels.row(k);
        const bool is_hit = hits.triangle[k] >= 0;
        places.on_face.push_back(is_hit);
        int moved = -1;
        if (is_hit) {
            const Eigen::Vector3d place = view.at(hits.triangle[k], hits.weights.row(k));
            moved = skin_before(view, pixel, place, view.cosine(hits.triangle[k], place) < kSteep);
        } else {
            moved = nearest_shown(view, pixel);
        }
        if (moved >= 0) {
            const auto shown = static_cast<std::size_t>(moved);
            places.triangle[k] = view.owner[shown];
            for (int corner = 0; corner < 3; ++corner) {
                places.weights(k, corner) = view.triangles(view.owner[shown], corner) == view.facing[shown];
            }
            places.offset.row(k) = (pixel - view.shown_at[shown]).transpose();
        }
    }
    settle_outline(view, pixels, places);
    return places;
}

}  // namespace mimetic
