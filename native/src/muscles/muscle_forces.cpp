// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

#include "line_points.hpp"

namespace mimetic {
namespace {

constexpr double kFootprintLimit = 3;  // standard deviations; the rest is 1 % of the peak

}  // namespace

void Muscle::check() const {
    const Eigen::Index least = type == MuscleType::linear ? 1 : 2;
    if (insertion.rows() < least || (type != MuscleType::sheet && insertion.rows() > least)) {
        throw InvalidInput("insertion has " + std::to_string(insertion.rows()) + " points, needed are " +
                           std::to_string(least));
    }
    if (!insertion.allFinite() || !origin.allFinite()) {
        throw InvalidInput("insertion and origin must be finite");
    }
    check_range("width", width, 1e-4, 1);
    check_range("normal_share", normal_share, 0, 1);
    check_range("protrusion", protrusion, 0, 100);
    check_range("swelling", swelling, 0, 1);
}

Points MuscleSurface::forces(const Muscle& muscle) const {
    muscle.check();
    return muscle.type == MuscleType::sphincter ? squeeze(muscle) : pull(muscle);
}

// The pull spreads over a Gaussian footprint; its reaction is at the bone and loads no skin.
Points MuscleSurface::pull(const Muscle& muscle) const {
    const Points edge = line_points(muscle.insertion, muscle.width / 4);
    const Eigen::VectorXd distance = distances(edge, kFootprintLimit * muscle.width);
    const Eigen::RowVector3d middle = edge.colwise().mean();
    const Eigen::RowVector3d direction = muscle.origin.transpose() - middle;
    if (!(direction.norm() > 1e-4)) {
        throw InvalidInput("origin and insertion coincide: the pull has no direction");
    }
    Points forces = Points::Zero(vertices_.rows(), 3);
    double total = 0;
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
        if (!std::isfinite(distance[v])) {
            continue;
        }
        const double ratio = distance[v] / muscle.width;
        const double weight = areas_[v] * std::exp(-ratio * ratio / 2);
        const Eigen::RowVector3d fibre = direction.normalized();
        const Eigen::RowVector3d across = fibre.dot(normals_.row(v)) * normals_.row(v);
        forces.row(v) = weight * (fibre - (1 - muscle.normal_share) * across);
        total += weight;
    }
    if (!(total > 0)) {
        throw InvalidInput("the insertion does not touch the skin");
    }
    return forces / total;
}

// Fibres run along curves of constant summed distance to the two foci (ellipses, for a flat face). They
// shorten with the same tension everywhere, which loads the skin with self-equilibrated forces: a lip
// contracts without buckling.
Points MuscleSurface::squeeze(const Muscle& muscle) const {
    const Eigen::RowVector3d own = muscle.insertion.row(0);
    const Eigen::RowVector3d other = muscle.insertion.row(1);
    const Eigen::RowVector3d centre = (own + other) / 2;
    const double focal = (own - centre).norm();
    const Eigen::RowVector3d sideways = (own - centre) / focal;
    Eigen::VectorXd weight(vertices_.rows());
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
        const Eigen::RowVector3d p = vertices_.row(v);
        const double major = ((p - own).norm() + (p - other).norm()) / 2;
        const double minor = std::sqrt(std::max(0.0, major * major - focal * focal));
        const double side = 0.5 * (1 + std::tanh(2 * (p - centre).dot(sideways) / muscle.width));
        weight[v] = side * std::exp(-std::pow(minor / (1.5 * muscle.width), 4));
    }
    Points forces = Points::Zero(vertices_.rows(), 3);
    Eigen::RowVector3d outwards = Eigen::RowVector3d::Zero();
    for (Eigen::Index f = 0; f < triangles_.rows(); ++f) {
        const Eigen::RowVector3i face = triangles_.row(f);
        const double tension = (weight[face[0]] + weight[face[1]] + weight[face[2]]) / 3;
        const Eigen::Vector3d a = vertices_.row(face[0]);
        const Eigen::Vector3d b = vertices_.row(face[1]);
        const Eigen::Vector3d c = vertices_.row(face[2]);
        const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
        const Eigen::Vector3d p = (a + b + c) / 3;
        const Eigen::Vector3d away =
            (p - own.transpose()).normalized() + (p - other.transpose()).normalized();
        const Eigen::Vector3d fibre = normal.cross(away).normalized();
        const Eigen::Vector3d across = normal.cross(fibre);
        const Eigen::Matrix3d stress =
            tension * (fibre * fibre.transpose() - muscle.swelling * across * across.transpose());
        // The shape functions' slopes are the opposite edges, turned inwards.
        forces.row(face[0]) -= stress * normal.cross(c - b) / 2;
        forces.row(face[1]) -= stress * normal.cross(a - c) / 2;
        forces.row(face[2]) -= stress * normal.cross(b - a) / 2;
        outwards += tension * (b - a).cross(c - a).transpose() / 2;
    }
    // Lips are pushed to a point before the mouth, so that they meet as they come forward.
    const Eigen::RowVector3d meeting = centre + focal * outwards.normalized();
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
        const Eigen::RowVector3d push = (meeting - vertices_.row(v)).normalized();
        forces.row(v) += muscle.protrusion / muscle.width * weight[v] * areas_[v] * push;
    }
    return forces;
}

}  // namespace mimetic
