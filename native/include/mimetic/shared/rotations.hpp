// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <limits>
#include <mimetic/shared/types.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mimetic {

/// Rotations of a clip, one a frame. As quaternions, vectors or angles, neighbours in time take the nearest
/// of equivalent values, so that curves have no jumps.
using Rotations = std::vector<Eigen::Matrix3d>;

/// The matrix of the cross product with v: cross_matrix(v) w = v x w.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

/// The rotation about a vector by its length, radians (Rodrigues), or by `most` if that is less.
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector,
                                     double most = std::numeric_limits<double>::infinity());

/// Axis times angle, radians, 0 to pi: the inverse of rotation_from_vector.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

/// Radians by which the second pose is turned from the first.
double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// Radians by which each of N poses is turned from a reference.
Eigen::VectorXd angles_from(const std::vector<Eigen::Isometry3d>& poses, const Eigen::Isometry3d& reference);

/// N x 4 unit quaternions (w x y z), each nearest to the one before. [Bar-Itzhack 2000]: the eigenvector of
/// the largest eigenvalue, which has no special cases.
Rows<double, 4> quaternions(const Rotations& rotations);

/// N x 3 axes times angles, radians, each the one nearest to that before it: a rotation on past half a turn
/// gives vectors longer than pi, not a jump.
Points rotation_vectors(const Rotations& rotations);

/// How a rotation vector changes with a small turn put before its rotation: log(exp(d) exp(r)) = r + J d
/// [Sola et al. 2018, eq. 146]. Singular at a full turn.
Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& vector);

/// The rotation nearest to the sum of rotations, in least squares of their entries.
Eigen::Matrix3d mean_rotation(const Rotations& rotations);

/// The rotation nearest to a matrix, in least squares of its entries.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

/// N x 3 angles about x, y and z, radians. order: such as "XYZ", the first letter turns first, as in Blender:
/// "XYZ" is Rz Ry Rx. first: what the first row is near to; each later row is near to the one before.
/// Throws InvalidInput for another order.
Points euler_angles(const Rotations& rotations, const std::string& order,
                    const Eigen::Vector3d& first = Eigen::Vector3d::Zero());

}  // namespace mimetic
