// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <mimetic/head/mesh_frame.hpp>
#include <mimetic/head/model_mesh.hpp>
#include <mimetic/head/resting_head.hpp>
#include <mimetic/head/rig_motion.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

py::tuple tuple_of(const RigidMotion& motion) {
    return py::make_tuple(array_of<3, 3>(motion.rotations), motion.shifts);
}

RigidMotion motion_of(const DoubleArray& rotations, const Points& shifts) {
    RigidMotion motion{matrices_of<3, 3>(rotations, "rotations"), shifts};
    if (shifts.rows() != static_cast<Eigen::Index>(motion.rotations.size())) {
        throw InvalidInput("a motion needs a shift for each rotation");
    }
    return motion;
}

}  // namespace

void bind_head_rig_motion(py::module_& m) {
    m.attr("OBJECT_FROM_HEAD") = object_from_head();
    m.def(
        "world_from_object",
        [](const DoubleArray& poses, const Eigen::Matrix4d& world_from_scene_camera) {
            return array_of(world_from_object(poses_of(poses, "head_pose"), world_from_scene_camera));
        },
        "head_pose"_a, "world_from_scene_camera"_a,
        "(N, 4, 4) of the face object from camera-from-head poses (N, 4, 4); raises InvalidInput.");
    m.def(
        "motion_from_rest",
        [](const DoubleArray& poses, int rest, bool is_absolute, const Eigen::Vector3d& pivot) {
            return tuple_of(motion_from_rest(poses_of(poses, "poses"), rest, is_absolute, pivot));
        },
        "world_from_object"_a, "rest"_a, "is_absolute"_a, "pivot"_a,
        "Rotations (N, 3, 3) and shifts (N, 3) of a head, character frame, against the pose of index "
        "`rest`.");
    m.def(
        "bone_motion",
        [](const DoubleArray& rotations, const Points& shifts, const Eigen::Matrix3d& head_rest,
           const std::optional<Eigen::Matrix3d>& neck_rest, const Eigen::Matrix3d& axes, double neck_share,
           double followed_share, bool is_local, double units) {
            const BoneMotion motion =
                bone_motion(motion_of(rotations, shifts),
                            {head_rest, neck_rest, axes, neck_share, followed_share, is_local, units});
            return py::make_tuple(array_of<3, 3>(motion.head.rotations), motion.head.shifts,
                                  array_of<3, 3>(motion.neck));
        },
        py::kw_only(), "rotations"_a, "shifts"_a, "head_rest"_a, "neck_rest"_a, "axes"_a, "neck_share"_a,
        "followed_share"_a, "is_local"_a, "units"_a,
        "Rotations and shifts of a head's bone from its rest, and rotations of the neck's; see "
        "rig_motion.hpp.");
    m.def(
        "carry_object",
        [](const DoubleArray& rotations, const Points& shifts, const Eigen::Vector3d& location,
           const Eigen::Matrix3d& rotation, const Eigen::Matrix4d& world_from_parent,
           const Eigen::Matrix3d& axes, double scale) {
            return tuple_of(carry_object(motion_of(rotations, shifts), location, rotation, world_from_parent,
                                         axes, scale));
        },
        "rotations"_a, "shifts"_a, "location"_a, "rotation"_a, "world_from_parent"_a, "axes"_a, "scale"_a,
        "Rotations (N, 3, 3) and locations (N, 3) of an object that moves from where it is.");
    m.def(
        "place_object",
        [](const DoubleArray& poses, const Eigen::Vector3d& camera, const Eigen::Matrix4d& world_from_parent,
           const Eigen::Matrix3d& axes, double scale) {
            return tuple_of(place_object(poses_of(poses, "poses"), camera, world_from_parent, axes, scale));
        },
        "world_from_object"_a, "camera"_a, "world_from_parent"_a, "axes"_a, "scale"_a,
        "Rotations (N, 3, 3) and locations (N, 3) that put an object where the head is.");
    m.def(
        "axis_angles",
        [](const DoubleArray& rotations) { return axis_angles(matrices_of<3, 3>(rotations, "rotations")); },
        "rotations"_a, "(N, 4) angles, radians, and axes, without jumps.");
    m.def("rotation_of", &rotation_of, "matrix"_a, "what"_a,
          "The rotation (3, 3) nearest to a matrix that may scale; raises InvalidInput, naming `what`.");
    m.def("object_from_character", &object_from_character, "usual"_a, "places"_a, "metres_from_object"_a,
          "(4, 4): where a head is in an object, by landmarks (K, 3) of the template's and of this one's, "
          "metres.");
    m.def(
        "world_from_moved_head", &world_from_moved_head, "points"_a, "starts"_a, "corners"_a, "moved"_a,
        "world_from_object"_a, "units"_a = 1,
        "(4, 4): where a head without landmarks rests in the world, and where it faces.\n\n"
        "points: (V, 3), the object's frame; starts: of each polygon among corners (vertices); moved: (V,), "
        "how much the head's own controls move of each; world_from_object: (4, 4); units: of the world, per "
        "metre. Raises InvalidInput for a flat object and polygons that are none.");
    m.def(
        "marks_of", &marks_of, "points"_a, "count"_a,
        "(count,) vertices of a mesh that lie far from each other, by which now_from_noted tells a motion of "
        "the whole; points: (V, 3), at least one.");
    m.def(
        "now_from_noted", &now_from_noted, "noted"_a, "now"_a,
        "(4, 4) by which marks (K, 3) went from where they were noted to where they are now; the identity if "
        "they stayed, did not go all together, or lie in a plane.");
    m.def(
        "still_points",
        [](const DoubleArray& poses, const Eigen::Matrix3d& intrinsics, double height) {
            return still_points(poses_of(poses, "head_pose"), intrinsics, height);
        },
        "head_pose"_a, "intrinsics"_a, "height"_a,
        "(N, 4) pixels that hold a head still: the face's centre, and a point above it that goes with it.");
    m.def(
        "mesh_of_model",
        [](const HeadShape& shape, double lowest, double highest) {
            ModelMesh mesh = mesh_of_model(shape, lowest, highest);
            return py::make_tuple(std::move(mesh.vertices), std::move(mesh.faces));
        },
        "shape"_a, "lowest"_a = -std::numeric_limits<double>::infinity(),
        "highest"_a = std::numeric_limits<double>::infinity(),
        "Vertices (V, 3), metres, head frame, and quads (F, 4) of an ellipsoid or a planar patch.\n\n"
        "lowest, highest: between which y of the head frame an ellipsoid is wanted. Raises InvalidInput.");
}

}  // namespace mimetic::bindings
