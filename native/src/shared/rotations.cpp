// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>
#include <numbers>

namespace mimetic {

namespace {

constexpr double kSmall = 1e-8;  // radians: below it a sine is its angle to the last digit
constexpr double kTurn = 2 * std::numbers::pi;

Eigen::Vector4d quaternion_of(const Eigen::Matrix3d& r) {
    Eigen::Matrix4d matrix;
    const Eigen::Vector3d axis(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
    matrix(0, 0) = r.trace();
    matrix.block<1, 3>(0, 1) = axis.transpose();
    matrix.block<3, 1>(1, 0) = axis;
    matrix.block<3, 3>(1, 1) = r + r.transpose() - r.trace() * Eigen::Matrix3d::Identity();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(matrix).eigenvectors().col(3);
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector, double most) {
    const double angle = vector.norm();
    return angle < 1e-12 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() + cross_matrix(vector))
                         : Eigen::AngleAxisd(std::min(angle, most), vector / angle).toRotationMatrix();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
    const Eigen::AngleAxisd turn(rotation);
    return turn.angle() * turn.axis();
}

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

Eigen::VectorXd angles_from(const std::vector<Eigen::Isometry3d>& poses, const Eigen::Isometry3d& reference) {
    Eigen::VectorXd angles(static_cast<Eigen::Index>(poses.size()));
    for (Eigen::Index i = 0; i < angles.size(); ++i) {
        angles[i] = angle_between(reference, poses[static_cast<std::size_t>(i)]);
    }
    return angles;
}

Rows<double, 4> quaternions(const Rotations& rotations) {
    Rows<double, 4> result(rotations.size(), 4);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        const Eigen::Vector4d quaternion = quaternion_of(rotations[static_cast<std::size_t>(i)]);
        const double side = i == 0 ? quaternion[0] : quaternion.dot(result.row(i - 1));
        result.row(i) = std::copysign(1., side) * quaternion.transpose();
    }
    return result;
}

Points rotation_vectors(const Rotations& rotations) {
    const Rows<double, 4> turns = quaternions(rotations);
    Points vectors(turns.rows(), 3);
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        const Eigen::Vector3d part = turns.row(i).tail<3>();
        const double sine = part.norm();
        const Eigen::Vector3d axis = part / std::max(sine, kSmall);
        Eigen::Vector3d vector = sine > kSmall ? Eigen::Vector3d(2 * std::atan2(sine, turns(i, 0)) * axis)
                                               : Eigen::Vector3d(2 * part);
        if (i > 0) {  // a quaternion's two sides are angles a full turn apart
            vector +=
                kTurn * std::nearbyint((vectors.row(i - 1).dot(axis) - vector.dot(axis)) / kTurn) * axis;
        }
        vectors.row(i) = vector;
    }
    return vectors;
}

Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& vector) {
    const double angle = vector.norm();
    const Eigen::Matrix3d k = cross_matrix(vector);
    const double second =
        angle < 1e-3 ? 1. / 12 : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
    return Eigen::Matrix3d::Identity() - .5 * k + second * k * k;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    return svd.matrixU() * Eigen::Vector3d(1, 1, side).asDiagonal() * svd.matrixV().transpose();
}

Eigen::Matrix3d mean_rotation(const Rotations& rotations) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& rotation : rotations) {
        sum += rotation;
    }
    return nearest_rotation(sum);
}

Points euler_angles(const Rotations& rotations, const std::string& order, const Eigen::Vector3d& first) {
    static const std::array<std::string, 6> kOrders{"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"};
    if (std::find(kOrders.begin(), kOrders.end(), order) == kOrders.end()) {
        throw InvalidInput("order of rotation '" + order + "'; there are XYZ, XZY, YXZ, YZX, ZXY, ZYX");
    }
    const int i = order[0] - 'X', j = order[1] - 'X', k = order[2] - 'X';
    const double sign = (j - i + 3) % 3 == 1 ? 1 : -1;
    Points angles(rotations.size(), 3);
    Eigen::RowVector3d before = first.transpose();
    for (Eigen::Index row = 0; row < angles.rows(); ++row) {
        const Eigen::Matrix3d& r = rotations[static_cast<std::size_t>(row)];
        std::array<Eigen::RowVector3d, 2> choices;
        choices[0][i] = std::atan2(sign * r(k, j), r(k, k));
        choices[0][j] = std::atan2(-sign * r(k, i), std::hypot(r(i, i), r(j, i)));
        choices[0][k] = std::atan2(sign * r(j, i), r(i, i));
        choices[1] = choices[0].array() + std::numbers::pi;
        choices[1][j] = std::numbers::pi - choices[0][j];
        for (Eigen::RowVector3d& choice : choices) {
            for (int axis = 0; axis < 3; ++axis) {
                choice[axis] -= kTurn * std::nearbyint((choice[axis] - before[axis]) / kTurn);
            }
        }
        const bool is_other = (choices[1] - before).cwiseAbs().sum() < (choices[0] - before).cwiseAbs().sum();
        before = angles.row(row) = choices[is_other ? 1 : 0];
    }
    return angles;
}

}  // namespace mimetic
