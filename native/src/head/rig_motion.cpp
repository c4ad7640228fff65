// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/head/rig_motion.hpp>
#include <mimetic/shared/error.hpp>

#include "shared/robust.hpp"

namespace mimetic {
namespace {

constexpr double kStill = 1e-6;                // radians: no axis is defined
constexpr double kFlat = 1e-12;                // of a determinant
const Eigen::Vector3d kBridge(0, -.01, .085);  // metres, head frame: the bridge of a usual nose
constexpr double kAbove = .01;                 // metres, of what defines up
constexpr double kArm = .25;                   // picture heights: far enough for angles to be exact

/// Rotations about the same axes by a share of the angle.
Rotations shared(const Rotations& rotations, double share) {
    const Points vectors = rotation_vectors(rotations);
    Rotations result;
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        result.push_back(rotation_from_vector(share * vectors.row(i).transpose()));
    }
    return result;
}

double side_of(const Eigen::Matrix3d& matrix) { return matrix.determinant() < 0 ? -1 : 1; }

/// The matrix nearest to a parent's that keeps lengths: a rotation, of a mirrored parent a reflection.
Eigen::Matrix3d orthogonal_of(const Eigen::Matrix3d& parent) {
    return side_of(parent) * rotation_of(side_of(parent) * parent, "parent");
}

}  // namespace

Eigen::Matrix4d object_from_head() {
    return (Eigen::Matrix4d() << 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1).finished();
}

Eigen::Matrix4d scene_camera_from_camera() { return Eigen::Vector4d(1, -1, -1, 1).asDiagonal(); }

std::vector<Eigen::Isometry3d> world_from_object(const std::vector<Eigen::Isometry3d>& head_poses,
                                                 const Eigen::Matrix4d& world_from_scene_camera) {
    Eigen::Matrix4d world = world_from_scene_camera;
    const Eigen::RowVector3d lengths = world.topLeftCorner<3, 3>().colwise().norm();
    if (!world.allFinite() || lengths.minCoeff() < 1e-9) {
        throw InvalidInput("the camera's matrix is not 4 x 4, or flat; reset its scale");
    }
    world.topLeftCorner<3, 3>().array().rowwise() /= lengths.array();
    const Eigen::Matrix4d from_camera = world * scene_camera_from_camera();
    const Eigen::Matrix4d head_from_object = object_from_head().transpose();
    std::vector<Eigen::Isometry3d> poses(head_poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        poses[i].matrix() = from_camera * head_poses[i].matrix() * head_from_object;
    }
    return poses;
}

RigidMotion motion_from_rest(const std::vector<Eigen::Isometry3d>& world_from_object, int rest,
                             bool is_absolute, const Eigen::Vector3d& pivot) {
    const Eigen::Isometry3d& first = world_from_object.at(static_cast<std::size_t>(rest));
    const Eigen::Matrix3d axes = is_absolute ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(first.linear());
    RigidMotion moved{{}, Points(world_from_object.size(), 3)};
    for (const Eigen::Isometry3d& pose : world_from_object) {
        moved.shifts.row(static_cast<Eigen::Index>(moved.rotations.size())) =
            (pose * pivot - first * pivot).transpose() * axes;
        moved.rotations.push_back(axes.transpose() * pose.linear());
    }
    return moved;
}

BoneMotion bone_motion(const RigidMotion& moved, const BoneAxes& bones) {
    const Eigen::Matrix3d& axes = bones.axes;
    Rotations turns;
    for (const Eigen::Matrix3d& rotation : moved.rotations) {
        turns.push_back(axes * rotation * axes.transpose());
    }
    const Rotations neck = shared(turns, bones.neck_rest ? bones.neck_share : 0);
    const Rotations carried = shared(neck, bones.followed_share);
    BoneMotion motion{{{}, bones.units * moved.shifts * axes.transpose()}, {}};
    for (std::size_t i = 0; i < turns.size(); ++i) {
        motion.head.rotations.push_back(bones.head_rest.transpose() * carried[i].transpose() * turns[i] *
                                        bones.head_rest);
        auto shift = motion.head.shifts.row(static_cast<Eigen::Index>(i));
        shift = (shift * carried[i]).eval();
        if (bones.is_local) {
            shift = (shift * bones.head_rest).eval();
        }
        if (bones.neck_rest) {
            motion.neck.push_back(bones.neck_rest->transpose() * neck[i] * *bones.neck_rest);
        }
    }
    return motion;
}

RigidMotion carry_object(const RigidMotion& moved, const Eigen::Vector3d& location,
                         const Eigen::Matrix3d& rotation, const Eigen::Matrix4d& world_from_parent,
                         const Eigen::Matrix3d& axes, double scale) {
    const Eigen::Matrix3d parent = world_from_parent.topLeftCorner<3, 3>();
    const Eigen::Matrix3d own = orthogonal_of(parent).transpose() * axes;
    RigidMotion carried;
    carried.shifts = (scale * moved.shifts * axes.transpose() * parent.inverse().transpose()).rowwise() +
                     location.transpose();
    for (const Eigen::Matrix3d& turn : moved.rotations) {
        carried.rotations.push_back(own * turn * own.transpose() * rotation);
    }
    return carried;
}

RigidMotion place_object(const std::vector<Eigen::Isometry3d>& world_from_object,
                         const Eigen::Vector3d& camera, const Eigen::Matrix4d& world_from_parent,
                         const Eigen::Matrix3d& axes, double scale) {
    rotation_of(world_from_parent.topLeftCorner<3, 3>(), "parent");
    const Eigen::Matrix4d parent_from_world = world_from_parent.inverse();
    const Eigen::Matrix3d linear = parent_from_world.topLeftCorner<3, 3>();
    const Eigen::Matrix3d turn = orthogonal_of(linear);
    // Rotations undo no mirroring: the head is mirrored from side to side, so that it stays upright
    const Eigen::Matrix3d mirrored_axes = axes * Eigen::Vector3d(side_of(linear), 1, 1).asDiagonal();
    RigidMotion placed{{}, Points(world_from_object.size(), 3)};
    for (const Eigen::Isometry3d& pose : world_from_object) {
        const Eigen::Vector3d point = camera + scale * (pose.translation() - camera);
        placed.shifts.row(static_cast<Eigen::Index>(placed.rotations.size())) =
            (linear * point + parent_from_world.topRightCorner<3, 1>()).transpose();
        placed.rotations.push_back(turn * pose.linear() * mirrored_axes.transpose());
    }
    return placed;
}

Rows<double, 4> axis_angles(const Rotations& rotations) {
    const Points vectors = rotation_vectors(rotations);
    const Eigen::VectorXd lengths = vectors.rowwise().norm();
    Eigen::RowVector3d before(0, 1, 0);
    for (Eigen::Index i = vectors.rows(); i-- > 0;) {
        if (lengths[i] >= kStill) {
            before = vectors.row(i) / lengths[i];
        }
    }
    Rows<double, 4> result(vectors.rows(), 4);
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        if (lengths[i] < kStill) {
            result.row(i) << vectors.row(i).dot(before), before;
            continue;
        }
        const double side = vectors.row(i).dot(before) < 0 ? -1 : 1;
        before = side * vectors.row(i) / lengths[i];
        result.row(i) << side * lengths[i], before;
    }
    return result;
}

Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& matrix, const std::string& what) {
    if (!matrix.allFinite() || std::abs(matrix.determinant()) < kFlat) {
        throw InvalidInput("the " + what + "'s matrix is flat or not finite; reset its scale");
    }
    return nearest_rotation(matrix);
}

Eigen::Matrix4d object_from_character(PointsIn usual, PointsIn places,
                                      const Eigen::Matrix4d& metres_from_object) {
    rotation_of(metres_from_object.topLeftCorner<3, 3>(), "object");
    const Similarity laid = fit_similarity(usual, places);
    if (laid.is_mirror) {
        throw InvalidInput("the landmarks are a mirror image of a face's: .L is the subject's own left");
    }
    Eigen::Matrix4d metres_from_character = Eigen::Matrix4d::Identity();
    metres_from_character.topLeftCorner<3, 3>() =
        laid.rotation * object_from_head().topLeftCorner<3, 3>().transpose();
    metres_from_character.topRightCorner<3, 1>() = laid.shift;
    return metres_from_object.inverse() * metres_from_character;
}

Rows<double, 4> still_points(const std::vector<Eigen::Isometry3d>& head_poses,
                             const Eigen::Matrix3d& intrinsics, double height) {
    const auto project = [&](const Eigen::Vector3d& point) -> Eigen::Vector2d {
        return (intrinsics * point).hnormalized();
    };
    Eigen::VectorXd depths(head_poses.size());
    for (Eigen::Index i = 0; i < depths.size(); ++i) {
        depths[i] = (head_poses[static_cast<std::size_t>(i)] * kBridge).z();
    }
    const double usual = median({depths.begin(), depths.end()});
    Rows<double, 4> points(depths.size(), 4);
    for (Eigen::Index i = 0; i < depths.size(); ++i) {
        const Eigen::Isometry3d& pose = head_poses[static_cast<std::size_t>(i)];
        const Eigen::Vector2d at = project(pose * kBridge);
        const Eigen::Vector2d upwards = project(pose * (kBridge + kAbove * Eigen::Vector3d::UnitY())) - at;
        // A nod by a quarter turn hides where up is; no face is seen then
        const Eigen::Vector2d direction = upwards / std::max(upwards.norm(), 1e-9);
        const Eigen::Vector2d above = at + kArm * height * usual / depths[i] * direction;
        points.row(i) << at.transpose(), above.transpose();
    }
    return points;
}

}  // namespace mimetic
