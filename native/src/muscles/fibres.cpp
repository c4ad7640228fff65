// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/muscles/fibres.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

#include "interpolate.hpp"

namespace mimetic {
namespace {

constexpr double kFibreSpacing = .006;      // m, of a sheet
constexpr double kRingRadii[] = {.6, 1.6};  // of a sphincter's fibres, in its widths

/// Ellipses about the foci, the half on the muscle's own side.
std::vector<Points> half_rings(const Muscle& muscle, int num_steps) {
    const Eigen::RowVector3d own = muscle.insertion.row(0), other = muscle.insertion.row(1);
    const Eigen::RowVector3d centre = (own + other) / 2;
    const double focal = (own - other).norm() / 2;
    const Eigen::RowVector3d aside = (own - centre) / focal;
    const Eigen::RowVector3d up = (Eigen::RowVector3d(0, 1, 0) - aside[1] * aside).normalized();
    std::vector<Points> rings;
    for (const double radius : kRingRadii) {
        const double minor = radius * muscle.width, major = std::hypot(focal, minor);
        Points ring(num_steps, 3);
        for (int i = 0; i < num_steps; ++i) {
            const double angle = std::numbers::pi * (static_cast<double>(i) / (num_steps - 1) - .5);
            ring.row(i) = centre + major * std::cos(angle) * aside + minor * std::sin(angle) * up;
        }
        rings.push_back(ring);
    }
    return rings;
}

}  // namespace

Points insertion_nodes(const Muscle& muscle) {
    if (muscle.type != MuscleType::sheet) {
        return muscle.insertion.topRows(1);
    }
    Eigen::VectorXd ways = Eigen::VectorXd::Zero(muscle.insertion.rows());
    for (Eigen::Index k = 1; k < ways.size(); ++k) {
        ways[k] = ways[k - 1] + (muscle.insertion.row(k) - muscle.insertion.row(k - 1)).norm();
    }
    const double whole = ways[ways.size() - 1];
    const Eigen::Index count = 2 + static_cast<Eigen::Index>(whole / kFibreSpacing);
    Points nodes(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double way = whole * static_cast<double>(i) / static_cast<double>(count - 1);
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            nodes(i, axis) = interpolate(way, ways, muscle.insertion.col(axis));
        }
    }
    return nodes;
}

std::vector<Points> muscle_fibres(const Muscle& muscle, int num_steps) {
    if (num_steps < 2) {
        throw InvalidInput("a fibre needs two points at least");
    }
    muscle.check();
    if (muscle.type == MuscleType::sphincter) {
        return half_rings(muscle, num_steps);
    }
    const Points ends = insertion_nodes(muscle);
    const Eigen::RowVector3d middle = ends.colwise().mean();
    std::vector<Points> fibres;
    for (Eigen::Index k = 0; k < ends.rows(); ++k) {
        const Eigen::RowVector3d start = muscle.origin.transpose() + ends.row(k) - middle;
        Points fibre(num_steps, 3);
        for (int i = 0; i < num_steps; ++i) {
            fibre.row(i) = start + static_cast<double>(i) / (num_steps - 1) * (ends.row(k) - start);
        }
        fibres.push_back(fibre);
    }
    return fibres;
}

Points MuscleLines::positions(PointsIn vertices, VectorIn jaw_values, double lift) const {
    const Points skin = places.positions(vertices, lift);
    if (jaw_values.size() != bone.rows() || bone.cols() != 3 * skin.rows()) {
        throw InvalidInput("lines of muscles are given other motions of the jaw than they have");
    }
    const Eigen::RowVectorXd moved = jaw_values.transpose() * bone;
    const Points foot = rest + Eigen::Map<const Points>(moved.data(), skin.rows(), 3);
    return foot + ((skin - foot).array().colwise() * share.array()).matrix();
}

}  // namespace mimetic
