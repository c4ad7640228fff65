// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/muscles/eyeballs.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

namespace mimetic {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr Eigen::Index kTurnModes = 5;

/// Closure by the gaze alone, negative as the lid rises.
Eigen::ArrayXd carried_at(const LidFollowing& lid, const Eigen::VectorXd& closure,
                          const Eigen::VectorXd& pitch) {
    if (closure.size() != pitch.size()) {
        throw InvalidInput("a lid's closure and the gaze need the same number of values");
    }
    return (lid.per_degree * (lid.rest_pitch - pitch.array()))
        .max(LidFollowing::kLowestCarried)
        .min(LidFollowing::kHighestCarried);
}

}  // namespace

Eigen::Vector3d gaze_direction(const EyeAngles& angles) {
    const double yaw = angles.yaw * kDegree, pitch = angles.pitch * kDegree;
    return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

EyeAngles gaze_angles(const Eigen::Vector3d& direction) {
    const Eigen::Vector3d unit = direction.normalized();
    return {std::atan2(unit.x(), unit.z()) / kDegree, std::asin(std::clamp(unit.y(), -1., 1.)) / kDegree};
}

Eigen::Matrix3d eye_rotation(const EyeAngles& angles) {
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), gaze_direction(angles))
        .toRotationMatrix();
}

Points turned_eyeballs(PointsIn vertices, const Eigen::VectorXi& eye_of, PointsIn centres,
                       const std::array<EyeAngles, 2>& turns) {
    if (eye_of.size() != vertices.rows() || centres.rows() != 2 ||
        (eye_of.size() > 0 && (eye_of.minCoeff() < 0 || eye_of.maxCoeff() > 2))) {
        throw InvalidInput("eyeballs need two centres and a number of 0 to 2 for each of the " +
                           std::to_string(vertices.rows()) + " vertices");
    }
    const std::array rotations{eye_rotation(turns[0]), eye_rotation(turns[1])};
    Points turned = vertices;
    for (Eigen::Index v = 0; v < turned.rows(); ++v) {
        if (eye_of[v] > 0) {
            const Eigen::RowVector3d centre = centres.row(eye_of[v] - 1);
            const Eigen::Matrix3d& rotation = rotations[static_cast<std::size_t>(eye_of[v] - 1)];
            turned.row(v) = centre + (turned.row(v) - centre) * rotation.transpose();
        }
    }
    return turned;
}

Points iris_circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& iris_centre, const EyeAngles& turn,
                   double radius, int count) {
    const Eigen::Vector3d arm = iris_centre - centre;
    const double ball = arm.norm();
    if (!(ball > radius) || count < 0) {
        throw InvalidInput("an iris of " + std::to_string(radius) + " m does not fit an eyeball of " +
                           std::to_string(ball));
    }
    const Eigen::Matrix3d rotation =
        eye_rotation(turn) * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), arm);
    Points circle(1 + count, 3);
    circle.row(0) = (centre + ball * rotation.col(2)).transpose();
    const double depth = std::sqrt(ball * ball - radius * radius);
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        const Eigen::Vector3d rim(radius * std::cos(angle), radius * std::sin(angle), depth);
        circle.row(1 + i) = (centre + rotation * rim).transpose();
    }
    return circle;
}

MatrixRows eye_turn_modes(PointsIn points, const Eigen::RowVector3d& centre) {
    Eigen::Matrix3d about_x, about_y;  // cross products with x and y
    about_x << 0, 0, 0, 0, 0, -1, 0, 1, 0;
    about_y << 0, 0, 1, 0, 0, 0, -1, 0, 0;
    const std::array<Eigen::Matrix3d, kTurnModes> turns{
        about_x, about_y, about_x * about_x, about_x * about_y + about_y * about_x, about_y * about_y};
    MatrixRows modes(kTurnModes, 3 * points.rows());
    for (Eigen::Index k = 0; k < points.rows(); ++k) {
        const Eigen::RowVector3d arm = points.row(k) - centre;
        for (Eigen::Index mode = 0; mode < kTurnModes; ++mode) {
            modes.row(mode).segment<3>(3 * k) = arm * turns[static_cast<std::size_t>(mode)].transpose();
        }
    }
    return modes;
}

MatrixRows eye_turn_weights(const Eigen::VectorXd& yaw, const Eigen::VectorXd& pitch) {
    if (yaw.size() != pitch.size()) {
        throw InvalidInput("yaw and pitch need the same number of values");
    }
    MatrixRows weights(yaw.size(), kTurnModes);
    for (Eigen::Index i = 0; i < yaw.size(); ++i) {
        // From z to d: I + [v] + [v]^2 / (1 + d_z) with v = z x d
        const Eigen::Vector3d d = gaze_direction({yaw[i], pitch[i]});
        const double x = -d.y(), y = d.x(), share = 1 / (1 + d.z());
        weights.row(i) << x, y, share * x * x, share * x * y, share * y * y;
    }
    return weights;
}

Eigen::MatrixX2d gaze_offsets(const Eigen::VectorXd& yaw, const Eigen::VectorXd& pitch, double distance) {
    if (yaw.size() != pitch.size()) {
        throw InvalidInput("yaw and pitch need the same number of values");
    }
    Eigen::MatrixX2d offsets(yaw.size(), 2);
    for (Eigen::Index i = 0; i < yaw.size(); ++i) {
        if (!(std::abs(yaw[i]) <= kFarthestTurn && std::abs(pitch[i]) <= kFarthestTurn)) {
            throw InvalidInput("an eye is turned by " + std::to_string(yaw[i]) + " and " +
                               std::to_string(pitch[i]) + " degrees; a target in front of it reaches " +
                               std::to_string(kFarthestTurn));
        }
        const Eigen::Vector3d d = gaze_direction({yaw[i], pitch[i]});
        offsets.row(i) << distance * d.x() / d.z(), distance * d.y() / d.z();
    }
    return offsets;
}

Eigen::VectorXd LidFollowing::seen(const Eigen::VectorXd& own, const Eigen::VectorXd& pitch) const {
    const Eigen::ArrayXd carried = carried_at(*this, own, pitch);
    return own.array() + carried * (1 - own.array());
}

Eigen::VectorXd LidFollowing::own(const Eigen::VectorXd& seen, const Eigen::VectorXd& pitch) const {
    const Eigen::ArrayXd carried = carried_at(*this, seen, pitch);
    return (seen.array() - carried) / (1 - carried);
}

double lid_following(const EyeLids& lids) {
    return kUpperFollows * kDegree / lids.upper_angle().cwiseAbs().maxCoeff();
}

}  // namespace mimetic
