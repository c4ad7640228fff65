# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures: which bones are head and neck, and how the head follows the neck."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Quaternion

from .. import native

# Controls of Rigify, Auto-Rig Pro, Mixamo, Character Creator and 3ds Max's biped, or plain names
HEADS = ("head", "c_head.x", "mixamorig:head", "cc_base_head", "bip01 head", "def-head", "head.x")
NECKS = ("neck", "c_neck.x", "mixamorig:neck", "cc_base_necktwist01", "bip01 neck", "neck.x")
METARIG = "spine.006"  # Rigify's meta-rigs call the head so
TRIAL_TURN = 0.5  # radians


@dataclass(frozen=True)
class HeadBones:
    head: str
    neck: str  # empty if there is none
    remark: str  # what the user should know, or the empty string


def head_bones(armature: bpy.types.Object) -> HeadBones:
    """The bones that animators turn for head and neck; empty names where none is known."""
    bones = armature.data.bones
    names = {bone.name.lower(): bone.name for bone in bones}
    head = next((names[name] for name in HEADS if name in names), "")
    neck = next((names[name] for name in NECKS if name in names), "")
    if not head and METARIG in bones:
        return HeadBones(
            "",
            "",
            rpt_("{name} is Rigify's meta-rig: Generate, then choose the generated rig").format(
                name=armature.name
            ),
        )
    if not head:
        return HeadBones(
            "", "", rpt_("{name} has no bone called head: choose one").format(name=armature.name)
        )
    return HeadBones(head, neck if _is_above(bones[head], neck) or not neck else "", "")


def no_whole_motion(armature: bpy.types.Object) -> str:
    """Why an armature may not be moved as a whole: a meta-rig moves nothing."""
    names = head_bones(armature)
    return names.remark if not names.head and METARIG in armature.data.bones else ""


def _is_above(bone: bpy.types.Bone, name: str) -> bool:
    return any(parent.name == name for parent in bone.parent_recursive)


def followed_share(armature: bpy.types.Object, head: str, neck: str) -> float:
    """The part of the neck's turns that reaches the head: constraints may keep it upright.

    Found by turning the neck a little and looking; the pose is put back.
    """
    neck_bone = armature.pose.bones[neck]
    before = neck_bone.matrix_basis.copy()
    at_rest = _orientation(armature, head)
    # About an axis oblique to all of the bone's own, any of which may be locked by a constraint
    axis = (1 / sqrt(3),) * 3
    neck_bone.matrix_basis = before @ Quaternion(axis, TRIAL_TURN).to_matrix().to_4x4()
    try:
        orientation = _orientation(armature, head)
    finally:
        neck_bone.matrix_basis = before
        bpy.context.view_layer.update()
    return native.rig_motion().followed(at_rest, orientation, TRIAL_TURN)


def _orientation(armature: bpy.types.Object, name: str):
    bpy.context.view_layer.update()
    evaluated_rig = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return evaluated_rig.pose.bones[name].matrix.to_3x3()


def as_bone(armature: bpy.types.Object, name: str):
    """A `mimetic.rig_motion.Bone` of a bone."""
    pose_bone = armature.pose.bones[name]
    return native.rig_motion().Bone(
        rest=native.array(pose_bone.bone.matrix_local.to_3x3()),
        rotation_mode=pose_bone.rotation_mode,
        can_move=not (pose_bone.bone.use_connect and pose_bone.bone.parent),
        is_local=pose_bone.bone.use_local_location,
    )
