// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/rotations.hpp>
#include <mimetic/shared/similarity.hpp>
#include <mimetic/shared/types.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mimetic {

/// The head's motion transferred to objects and to bones of any armature.
///
/// Frames of scenes whose z points up and whose characters face -y. *Object*, the face's own: x to the
/// person's left, z up, the face towards -y, origin midway between the ears; *character*, the same of any
/// character; *scene camera*: x right, y up, looking along -z. A rotation in the character frame is
/// expressed in the rest axes of its target, so that a character looks to its own left when the actor does,
/// however its bones are oriented. Metres unless said otherwise.

Eigen::Matrix4d object_from_head();
Eigen::Matrix4d scene_camera_from_camera();

/// Rotations and translations, one a frame.
struct RigidMotion {
    Rotations rotations;
    Points shifts;  ///< N x 3
};

/// Poses of the face object in the world from camera-from-head ones. The scale of the camera is ignored, as
/// when it renders. Throws InvalidInput if its matrix is flat or not finite.
std::vector<Eigen::Isometry3d> world_from_object(const std::vector<Eigen::Isometry3d>& head_poses,
                                                 const Eigen::Matrix4d& world_from_scene_camera);

/// The head's motion in the character frame against the frame of index `rest`, in the axes that the head has
/// there, or in the world's if `is_absolute`: turns are then 0 where the head faces the camera straight.
/// Shifts are those of a point fixed to the head (pivot) and 0 at rest.
RigidMotion motion_from_rest(const std::vector<Eigen::Isometry3d>& world_from_object, int rest,
                             bool is_absolute, const Eigen::Vector3d& pivot);

/// How the bones of head and neck take a motion.
struct BoneAxes {
    Eigen::Matrix3d head_rest;                 ///< armature from bone
    std::optional<Eigen::Matrix3d> neck_rest;  ///< none: there is no neck
    Eigen::Matrix3d axes;                      ///< armature from character
    double neck_share = 0;                     ///< part of each turn that the neck takes
    double followed_share = 1;                 ///< of the neck's turn that reaches the head by the armature
    bool is_local = true;                      ///< locations are along the bone's own axes
    double units = 1;                          ///< of the armature's space, per metre
};

struct BoneMotion {
    RigidMotion head;  ///< of the bone, from its rest
    Rotations neck;    ///< empty without a neck
};

BoneMotion bone_motion(const RigidMotion& moved, const BoneAxes& bones);

/// Channels of an object that moves from where it is: location and rotation, its present channels;
/// parent: world from parent; axes: world from character; scale: of shifts. Throws InvalidInput if the parent
/// is flat.
RigidMotion carry_object(const RigidMotion& moved, const Eigen::Vector3d& location,
                         const Eigen::Matrix3d& rotation, const Eigen::Matrix4d& world_from_parent,
                         const Eigen::Matrix3d& axes, double scale);

/// Channels that put an object where the head is. camera: where it stands in the world; axes: object from
/// character; scale: of the distance to the camera. Under a mirrored parent the head is upright, its left
/// where its right was. Throws InvalidInput if the parent is flat.
RigidMotion place_object(const std::vector<Eigen::Isometry3d>& world_from_object,
                         const Eigen::Vector3d& camera, const Eigen::Matrix4d& world_from_parent,
                         const Eigen::Matrix3d& axes, double scale);

/// N x 4 angles (radians) and axes without jumps: through rest the angle changes sign, not the axis.
Rows<double, 4> axis_angles(const Rotations& rotations);

/// The rotation nearest to a matrix that may scale; throws InvalidInput, naming `what`, if it is flat.
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& matrix, const std::string& what);

/// Object from character: position and orientation of a head in an object. usual, places: K x 3, landmarks
/// of the canonical head and of this one, metres; metres_from_object: as it was for those places.
/// Throws InvalidInput if that is flat.
Eigen::Matrix4d object_from_character(PointsIn usual, PointsIn places,
                                      const Eigen::Matrix4d& metres_from_object);

/// Pixels that hold the head still in the picture, N x 4: the face's centre (x, y), and a point above it that
/// goes with the head. Holding both removes the head's translation, roll and change of distance; the second
/// one's distance follows depth alone, so a head that turns or nods is not zoomed. head_poses: camera from
/// head; intrinsics: pixels; height: of the picture.
Rows<double, 4> still_points(const std::vector<Eigen::Isometry3d>& head_poses,
                             const Eigen::Matrix3d& intrinsics, double height);

}  // namespace mimetic
