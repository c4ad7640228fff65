// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/muscles/extras.hpp>
#include <mimetic/muscles/eyeballs.hpp>
#include <mimetic/shared/error.hpp>
#include <numeric>

#include "interpolate.hpp"
#include "line_points.hpp"

namespace mimetic {
namespace {

constexpr double kLineSpacing = 0.0015;  // m, of the points that stand for a line
constexpr double kFootprintLimit = 3;    // standard deviations
constexpr double kSlitFade = 0.003;      // m; the push to the slit fades where the lips meet
constexpr double kLipDepth = 0.003;      // m; the lip's core lies so far under its skin
constexpr double kLowerFollows = 0.3;    // of the eye's turn up and down, at the lower lid's middle; assumed

PlacedExtra place_extra(const SkinMesh& canonical, const SkinMesh& mesh, const ExtraEntry& entry,
                        const std::string& sides) {
    PlacedExtra placed{entry, Points(0, 3), 0, find_place(canonical, entry.measured_at, sides[0]), 0};
    double scale = 0;
    for (const char side : sides) {
        Points corners(entry.line.size(), 3);
        for (Eigen::Index i = 0; i < corners.rows(); ++i) {
            const Place place = find_place(canonical, entry.line[i], side);
            corners.row(i) = place.position(mesh);
            scale += place.scale(mesh);
        }
        const Points own = line_points(corners, kLineSpacing);
        const Eigen::Index before = placed.line.rows();
        placed.line.conservativeResize(before + own.rows(), 3);
        placed.line.bottomRows(own.rows()) = own;
    }
    placed.width = 1e-3 * entry.width * scale / static_cast<double>(sides.size() * entry.line.size());
    placed.excursion = 1e-3 * entry.excursion * placed.measured.scale(mesh);
    return placed;
}

/// Share of the load at each vertex; the sum is 1.
Eigen::VectorXd footprint(const MuscleSurface& surface, const PlacedExtra& extra) {
    const Eigen::VectorXd distance = surface.distances(extra.line, kFootprintLimit * extra.width);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(distance.size());
    for (Eigen::Index v = 0; v < weight.size(); ++v) {
        if (std::isfinite(distance[v])) {
            const double ratio = distance[v] / extra.width;
            weight[v] = surface.areas()[v] * std::exp(-0.5 * ratio * ratio);
        }
    }
    if (!(weight.sum() > 0)) {
        throw InvalidInput("the line of " + extra.entry.name + " does not touch the skin");
    }
    return weight / weight.sum();
}

/// Forwards, and to the height of the slit between the lips; unit at most.
Points push_direction(const MuscleSurface& surface, const MouthFrame& mouth, const ExtraEntry& entry) {
    Points direction = Points::Zero(surface.vertices().rows(), 3);
    const double length = std::hypot(entry.inwards, entry.forwards);
    for (Eigen::Index v = 0; v < direction.rows(); ++v) {
        const double to_slit = mouth.slit[1] - surface.vertices()(v, 1);
        const double inwards = std::clamp(to_slit / (kSlitFade * mouth.size), -1.0, 1.0);
        direction.row(v) << 0, entry.inwards * inwards / length, entry.forwards / length;
    }
    return direction;
}

/// A couple about each piece of the lip: free edge forward, outer border back. Forces are perpendicular to
/// the lever arm from its axis; their sum is subtracted, so that the lip turns and is not pushed.
Points roll_forces(const MuscleSurface& surface, const MouthFrame& mouth, const PlacedExtra& extra,
                   const Eigen::VectorXd& weight) {
    std::vector<Eigen::Index> order(extra.line.rows());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return extra.line(a, 0) < extra.line(b, 0); });
    const Points line = extra.line(order, Eigen::all);
    const Eigen::VectorXd xs = line.col(0);
    const Eigen::VectorXd ys = line.col(1);
    const Eigen::VectorXd zs = line.col(2);
    const Eigen::RowVector3d turn(extra.entry.upper ? -1 : 1, 0, 0);
    Points forces(weight.size(), 3);
    for (Eigen::Index v = 0; v < forces.rows(); ++v) {
        const Eigen::RowVector3d p = surface.vertices().row(v);
        const Eigen::RowVector3d arm(0, p[1] - interpolate(p[0], xs, ys),
                                     p[2] - interpolate(p[0], xs, zs) + kLipDepth * mouth.size);
        forces.row(v) = weight[v] * turn.cross(arm);
    }
    const Eigen::RowVector3d sum = forces.colwise().sum();
    return forces - weight * sum / weight.sum();
}

}  // namespace

std::vector<PlacedExtra> place_extras(const SkinMesh& canonical, const SkinMesh& mesh,
                                      const std::vector<ExtraEntry>& table) {
    std::vector<PlacedExtra> placed;
    for (const ExtraEntry& entry : table) {
        for (const char* sides : entry.paired ? std::vector{"L", "R"} : std::vector{"LR"}) {
            placed.push_back(place_extra(canonical, mesh, entry, sides));
        }
    }
    return placed;
}

MouthFrame mouth_frame(const SkinMesh& mesh) {
    return {mesh.mean_landmark({"lip_upper_inner", "lip_lower_inner"}), mesh.size()};
}

Points extra_forces(const MuscleSurface& surface, const MouthFrame& mouth, const PlacedExtra& extra) {
    const Eigen::VectorXd weight = footprint(surface, extra);
    if (extra.entry.type == ExtraType::pressure) {
        return weight.asDiagonal() * surface.normals();
    }
    if (extra.entry.type == ExtraType::push) {
        return weight.asDiagonal() * push_direction(surface, mouth, extra.entry);
    }
    return roll_forces(surface, mouth, extra, weight);
}

MatrixRows extra_responses(const AttachedSkin& skin, const MuscleSurface& surface, const MouthFrame& mouth,
                           const std::vector<PlacedExtra>& extras, const SparseRows& measured) {
    check_measured(measured, static_cast<Eigen::Index>(extras.size()), skin);
    MatrixRows forces(extras.size(), surface.vertices().size());
    for (Eigen::Index i = 0; i < forces.rows(); ++i) {
        const Points own = extra_forces(surface, mouth, extras[i]);
        forces.row(i) = Eigen::Map<const Eigen::RowVectorXd>(own.data(), own.size());
    }
    MatrixRows responses = skin.respond(forces);
    for (Eigen::Index i = 0; i < forces.rows(); ++i) {
        const ExtraEntry& entry = extras[i].entry;
        const double moved = motion_at(measured, i, responses.row(i)).norm();
        check_moves(moved, entry.name, entry.measured_at.anchor);
        responses.row(i) *= extras[i].excursion / moved;
    }
    return responses;
}

Points turned_eye(const EyeFrame& frame, const Gaze& gaze, PointsIn points) {
    Eigen::RowVector3d axis = gaze.axis;
    if (frame.side == 'R') {
        axis.tail<2>() *= -1;  // mirrored: an axis is a pseudovector
    }
    return rotate(points, frame.centre, axis, Eigen::VectorXd::Constant(points.rows(), gaze.angle)) - points;
}

Eigen::VectorXd lid_angle(const EyeLids& lids, const Gaze& gaze) {
    const double down = gaze.axis[0] * gaze.angle;  // positive: down, as lids turn
    const Eigen::VectorXd upper = lids.upper_angle();
    const Eigen::VectorXd lower = lids.lower_angle();
    return kUpperFollows * down / upper.cwiseAbs().maxCoeff() * upper -
           kLowerFollows * down / lower.cwiseAbs().maxCoeff() * lower;
}

}  // namespace mimetic
