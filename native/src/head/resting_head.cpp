// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <mimetic/head/resting_head.hpp>
#include <mimetic/head/rig_motion.hpp>
#include <mimetic/retarget/seen_areas.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

constexpr double kEarsBehind = .08;  // metres, of the middle of a face
constexpr double kAhead = 3;  // weight of where the face looks, against what is up: a character may lie

/// Where nothing tells, y is behind and z up, as in Blender, or y up, as in other programs.
Eigen::Matrix3d usual_axes() {
    Eigen::Matrix3d usual = Eigen::Matrix3d::Zero();
    usual(0, 0) = usual(2, 2) = 1e-3;
    usual(1, 1) = 1e-4;
    usual(1, 2) = 5e-4;
    return usual;
}

Eigen::Vector3d middle(PointsIn points, const Eigen::VectorXd& weights) {
    const double total = weights.sum();
    return total > 0 ? Eigen::Vector3d(points.transpose() * weights / total)
                     : Eigen::Vector3d(points.colwise().mean());
}

/// The normal of what moves, by area and motion.
Eigen::Vector3d looks_of(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners,
                         const Eigen::VectorXd& moved) {
    Eigen::Vector3d looks = Eigen::Vector3d::Zero();
    for (std::size_t face = 0; face < starts.size(); ++face) {
        const auto begin = static_cast<std::size_t>(starts[face]);
        const std::size_t end =
            face + 1 < starts.size() ? static_cast<std::size_t>(starts[face + 1]) : corners.size();
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double motion = 0;
        for (std::size_t c = begin; c < end; ++c) {
            const Eigen::Vector3d here = points.row(corners[c]);
            const Eigen::Vector3d next = points.row(corners[c + 1 < end ? c + 1 : begin]);
            normal += here.cross(next);
            motion += moved[corners[c]];
        }
        looks += motion * normal;
    }
    return looks;
}

/// The 24 rotations that take axes to axes.
std::vector<Eigen::Matrix3d> quarter_turns() {
    std::array<Eigen::Vector3d, 6> ways;
    for (int axis = 0; axis < 3; ++axis) {
        ways[static_cast<std::size_t>(axis)] = Eigen::Vector3d::Unit(axis);
        ways[static_cast<std::size_t>(axis) + 3] = -Eigen::Vector3d::Unit(axis);
    }
    std::vector<Eigen::Matrix3d> turns;
    for (const Eigen::Vector3d& back : ways) {
        for (const Eigen::Vector3d& up : ways) {
            if (back.dot(up) == 0) {
                turns.emplace_back();
                turns.back() << back.cross(up), back, up;
            }
        }
    }
    return turns;
}

/// Of an object's axes, any way round: those by which one is up and the face looks `ahead`.
Eigen::Matrix3d likeliest_axes(const Eigen::Matrix3d& own, const Eigen::Vector3d& ahead) {
    const Eigen::Matrix3d usual = usual_axes();
    Eigen::Matrix3d best = own;
    double most = -std::numeric_limits<double>::infinity();
    for (const Eigen::Matrix3d& turn : quarter_turns()) {
        const Eigen::Matrix3d axes = own * turn;
        const double likelihood = axes(2, 2) - kAhead * ahead.dot(axes.col(1)) + (usual * turn).sum();
        if (likelihood > most) {
            most = likelihood;
            best = axes;
        }
    }
    return best;
}

}  // namespace

Eigen::Matrix4d world_from_moved_head(PointsIn points, const std::vector<int>& starts,
                                      const std::vector<int>& corners, VectorIn moved,
                                      const Eigen::Matrix4d& world_from_object, double units) {
    require(points.rows() > 0 && points.rows() == moved.size() && moved.allFinite(),
            "a head needs points, and how much each of them moves");
    const Eigen::Matrix3d linear = world_from_object.topLeftCorner<3, 3>();
    const double side = linear.determinant() < 0 ? -1 : 1;
    const Points placed = (points * linear.transpose()).rowwise() +
                          Eigen::RowVector3d(world_from_object.topRightCorner<3, 1>().transpose());
    const Eigen::VectorXd areas = polygon_areas(placed, starts, corners);
    const Eigen::VectorXd motion =
        (moved.array() != 0).any() ? Eigen::VectorXd(moved) : Eigen::VectorXd::Ones(points.rows());
    const Eigen::Vector3d centre = middle(placed, areas.cwiseProduct(motion));
    const double ears = kEarsBehind * units;
    const Eigen::ArrayXd distances = (placed.rowwise() - centre.transpose()).rowwise().squaredNorm();
    const Eigen::VectorXd near = (distances < 4 * ears * ears).cast<double>();
    // Lids at rest look down, and a jaw is low on its head: the mean of both looks ahead
    const Eigen::Vector3d behind = middle(placed, areas.cwiseProduct(near));
    const Eigen::Vector3d looks = side * looks_of(placed, starts, corners, motion);
    const Eigen::Vector3d ahead = (looks.normalized() + (centre - behind).normalized()).normalized();
    const Eigen::Matrix3d axes = likeliest_axes(linear.colwise().normalized(), ahead);
    Eigen::Matrix4d world_from_character = Eigen::Matrix4d::Identity();
    world_from_character.topLeftCorner<3, 3>() =
        rotation_of(axes * Eigen::Vector3d(side, 1, 1).asDiagonal(), "object");
    world_from_character.topRightCorner<3, 1>() =
        centre + ears * world_from_character.topLeftCorner<3, 3>().col(1);
    return world_from_character;
}

}  // namespace mimetic
