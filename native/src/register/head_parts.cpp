// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <mimetic/register/head_parts.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kReach = .02;   // of the head's extent, by which a part may reach out of its box
constexpr double kLargest = .5;  // of the head's extent: what is larger is no part of it

Eigen::Matrix3d linear_of(const Eigen::Matrix4d& head_from_part) {
    const Eigen::Matrix3d linear = head_from_part.topLeftCorner<3, 3>();
    if (!head_from_part.allFinite() || linear.determinant() == 0) {
        throw InvalidInput("a part of the head is scaled to nothing");
    }
    return linear;
}

}  // namespace

Points placed_points(PointsIn points, const Eigen::Matrix4d& head_from_part) {
    const Eigen::Matrix3d linear = linear_of(head_from_part);
    return (points * linear.transpose()).rowwise() + head_from_part.topRightCorner<3, 1>().transpose();
}

Points moved_in_part(PointsIn displacements, const Eigen::Matrix4d& head_from_part) {
    const Eigen::Matrix3d part_from_head = linear_of(head_from_part).inverse();
    return displacements * part_from_head.transpose();
}

bool is_mirror(const Eigen::Matrix4d& head_from_part) { return linear_of(head_from_part).determinant() < 0; }

bool lies_in_box(PointsIn head, PointsIn part) {
    if (head.rows() == 0 || part.rows() == 0 || !head.allFinite() || !part.allFinite()) {
        return false;
    }
    const Eigen::RowVector3d low = head.colwise().minCoeff(), high = head.colwise().maxCoeff();
    const Eigen::RowVector3d least = part.colwise().minCoeff(), most = part.colwise().maxCoeff();
    const double size = (high - low).maxCoeff();
    return (least.array() >= low.array() - kReach * size).all() &&
           (most.array() <= high.array() + kReach * size).all() &&
           (most - least).maxCoeff() < kLargest * size;
}

}  // namespace mimetic
