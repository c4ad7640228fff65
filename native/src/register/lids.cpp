// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mimetic/raster/rays.hpp>
#include <mimetic/register/lids.hpp>
#include <mimetic/shared/checks.hpp>
#include <numbers>
#include <optional>

#include "skin/mesh_edges.hpp"

namespace mimetic {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAside = .25;  // cosine of the way to a point and the front, from which an eye is seen
const Camera kOutwards{1, 1, 0, 0, 1, 1};
constexpr double kRimReach = .003;  // m on the template, from a registered rim to the skin's own
constexpr double kBehind =
    .85;  // of a registered rim's distance from the eye's middle: nearer lies the socket
constexpr double kBridged = .0003;  // m; rims that lie no further apart at rest are one
constexpr double kJoined = 1.5;     // of the gap, the way over skin that covers it

/// Where an edge of a triangle is cut by a plane across the lids.
struct Cut {
    Eigen::RowVector3d at;
    double elevation;
    Eigen::Index triangle;
    Eigen::RowVector3d weights;
};

/// All cuts of triangles with the plane at a place along the axis of an eye.
std::vector<Cut> cuts_at(double along, const EyeFrame::Polar& polar, PointsIn vertices, TrianglesIn triangles,
                         const std::vector<Eigen::Index>& rows) {
    std::vector<Cut> cuts;
    for (const Eigen::Index t : rows) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
            const double from = polar.along[a] - along, to = polar.along[b] - along;
            if (from == to || from * to > 0) {
                continue;
            }
            const double share = from / (from - to);
            Cut cut{(1 - share) * vertices.row(a) + share * vertices.row(b),
                    (1 - share) * polar.elevation[a] + share * polar.elevation[b], t,
                    Eigen::RowVector3d::Zero()};
            cut.weights[k] = 1 - share;
            cut.weights[(k + 1) % 3] = share;
            cuts.push_back(cut);
        }
    }
    return cuts;
}

/// Where a rim is looked for.
struct RimSearch {
    Eigen::RowVector3d centre, own, other;  // of the eye; the registered rim, and the one across
    double sign;                            // 1: its lowest cut, -1: its highest
    double reach;
};

const Cut* rim_of(const std::vector<Cut>& cuts, const RimSearch& search) {
    const double least = kBehind * (search.own - search.centre).norm();
    const Cut* best = nullptr;
    for (const Cut& cut : cuts) {
        const double to_own = (cut.at - search.own).norm();
        if (to_own < search.reach && to_own <= (cut.at - search.other).norm() &&
            (cut.at - search.centre).norm() > least &&
            (!best || search.sign * cut.elevation < search.sign * best->elevation)) {
            best = &cut;
        }
    }
    return best;
}

SkinPlaces places_of(const std::vector<Cut>& cuts, TrianglesIn triangles) {
    const auto count = static_cast<Eigen::Index>(cuts.size());
    SkinPlaces places{Triangles(count, 3), Points(count, 3), Eigen::VectorXd::Zero(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        const Cut& cut = cuts[static_cast<std::size_t>(i)];
        places.corners.row(i) = triangles.row(cut.triangle);
        places.weights.row(i) = cut.weights;
    }
    return places;
}

}  // namespace

EyeSurface::EyeSurface(const Eigen::Vector3d& centre, PointsIn vertices, TrianglesIn triangles)
    : centre_(centre), vertices_(vertices.rowwise() - centre.transpose()) {
    require(triangles.size() == 0 || (triangles.minCoeff() >= 0 && triangles.maxCoeff() < vertices.rows()),
            "a triangle names a vertex that the eyeball does not have");
    Components components(vertices.rows());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        components.join(triangles(t, 0), triangles(t, 1));
        components.join(triangles(t, 1), triangles(t, 2));
    }
    std::map<int, std::vector<Eigen::Index>> shells;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        shells[components.root(triangles(t, 0))].push_back(t);
    }
    for (const auto& [root, rows] : shells) {
        Triangles shell = triangles(rows, Eigen::all);
        shell.col(1).swap(shell.col(2));  // from within its outside faces away
        shells_.push_back(std::move(shell));
    }
}

Eigen::VectorXd EyeSurface::depths(PointsIn points) const {
    Eigen::VectorXd depths = Eigen::VectorXd::Constant(points.rows(), -kInfinity);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::RowVector3d arm = points.row(i) - centre_.transpose();
        if (arm.z() > kAside * arm.norm() && arm.norm() > 0) {
            rows.push_back(i);
        }
    }
    Points2 pixels(rows.size(), 2);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Eigen::Vector3d arm = points.row(rows[i]).transpose() - centre_;
        pixels.row(static_cast<Eigen::Index>(i)) = kOutwards.project(arm).transpose();
    }
    for (const Triangles& shell : shells_) {
        const RayHits hits = cast_rays(kOutwards, vertices_, shell, pixels);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            if (hits.triangle[row] >= 0) {
                const Eigen::RowVector3d hit =
                    hits.weights.row(row) * vertices_(shell.row(hits.triangle[row]), Eigen::all);
                const double distance = (points.row(rows[i]) - centre_.transpose()).norm();
                depths[rows[i]] = std::max(depths[rows[i]], hit.norm() - distance);
            }
        }
    }
    return depths;
}

Points EyeSurface::lifted(PointsIn points, double clearance) const {
    Points result = points;
    const Eigen::VectorXd deep = depths(points);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        if (deep[i] > -clearance) {
            const Eigen::RowVector3d arm = points.row(i) - centre_.transpose();
            result.row(i) += (deep[i] + clearance) * arm.normalized();
        }
    }
    return result;
}

SlitPlaces lid_rims(const EyeFrame& frame, PointsIn vertices, TrianglesIn triangles, PointsIn top,
                    PointsIn bottom) {
    require(top.rows() == bottom.rows(), "the rims of an eye come in pairs");
    const EyeFrame::Polar polar = frame.polar(vertices), above = frame.polar(top),
                          below = frame.polar(bottom);
    const double least = kRimReach * frame.mesh->size();
    const double widest = top.rows() ? (top - bottom).rowwise().norm().maxCoeff() : 0;
    std::vector<Eigen::Index> near;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::RowVector3d middle = vertices(triangles.row(t), Eigen::all).colwise().mean();
        const double extent =
            (vertices(triangles.row(t), Eigen::all).rowwise() - middle).rowwise().norm().maxCoeff();
        const double gap = std::min((top.rowwise() - middle).rowwise().norm().minCoeff(),
                                    (bottom.rowwise() - middle).rowwise().norm().minCoeff());
        if (gap < extent + std::max(least, widest)) {
            near.push_back(t);
        }
    }
    std::vector<Cut> upper, lower;
    for (Eigen::Index k = 0; k < top.rows(); ++k) {
        const std::vector<Cut> cuts =
            cuts_at((above.along[k] + below.along[k]) / 2, polar, vertices, triangles, near);
        const double reach = std::max(least, (top.row(k) - bottom.row(k)).norm() / 2);
        const Cut *high = rim_of(cuts, {frame.centre, top.row(k), bottom.row(k), 1, reach}),
                  *low = rim_of(cuts, {frame.centre, bottom.row(k), top.row(k), -1, reach});
        if (high && low && high->elevation > low->elevation &&
            (high->at - low->at).norm() > kBridged * frame.mesh->size()) {
            upper.push_back(*high);
            lower.push_back(*low);
        }
    }
    return {places_of(upper, triangles), places_of(lower, triangles)};
}

bool are_joined(const MuscleSurface& surface, PointsIn top, PointsIn bottom) {
    const Eigen::Index count = top.rows();
    int joined = 0, asked = 0;
    for (Eigen::Index k = count / 3; k < count - count / 3; ++k, ++asked) {
        Eigen::Index from = 0, to = 0;
        (surface.vertices().rowwise() - top.row(k)).rowwise().squaredNorm().minCoeff(&from);
        (surface.vertices().rowwise() - bottom.row(k)).rowwise().squaredNorm().minCoeff(&to);
        const double most = kJoined * (surface.vertices().row(from) - surface.vertices().row(to)).norm();
        joined += from == to || surface.distances(surface.vertices().row(from), 2 * most)[to] < most;
    }
    return asked > 0 && 2 * joined > asked;
}

double largest_depth(const MuscleSurface& surface, PointsIn displacement, const SlitPlaces& rims,
                     const EyeSurface& eye, double reach) {
    const Points& vertices = surface.vertices();
    require(displacement.rows() == vertices.rows(), "each vertex of the surface needs a displacement");
    Points margin(rims.upper.corners.rows() + rims.lower.corners.rows(), 3);
    margin << rims.upper.values(vertices), rims.lower.values(vertices);
    if (!eye.is_there() || margin.rows() == 0) {
        return 0;
    }
    const Eigen::VectorXd way = surface.distances(margin, reach);
    std::vector<Eigen::RowVector2i> places;
    for (Eigen::Index t = 0; t < surface.triangles().rows(); ++t) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int a = surface.triangles()(t, k), b = surface.triangles()(t, (k + 1) % 3);
            if (way[a] < reach && way[b] < reach) {
                places.emplace_back(a, a);
                places.emplace_back(a, b);
            }
        }
    }
    const auto at = [&](const Points& shape) {
        Points points(places.size(), 3);
        for (std::size_t i = 0; i < places.size(); ++i) {
            points.row(static_cast<Eigen::Index>(i)) =
                (shape.row(places[i][0]) + shape.row(places[i][1])) / 2;
        }
        return points;
    };
    const Eigen::VectorXd rest = eye.depths(at(vertices)), moved = eye.depths(at(vertices + displacement));
    double deepest = 0;
    for (Eigen::Index i = 0; i < rest.size(); ++i) {
        if (rest[i] < 0) {
            deepest = std::max(deepest, moved[i]);
        }
    }
    return deepest;
}

}  // namespace mimetic
