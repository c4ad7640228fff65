# SPDX-License-Identifier: GPL-3.0-or-later
"""What a button writes to. Functions named `no_...` say why it is grey, or nothing."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import clips, native, scene_in, writable
from .scene_out import (
    control_object,
    expression_strips,
    expressions,
    face_bones,
    face_curves,
    own_keys,
    rigs,
)


def no_bake(context) -> str:
    """Why the performance cannot be baked."""
    if reason := scene_in.no_performance(context):
        return reason
    if (head := bound_head(context)) is None:
        return no_update(context.scene)
    if head.mode == "EDIT":
        return iface_("Leave {name}'s edit mode first").format(name=head.name)
    return writable.no_sliders(head)


def bound_head(context) -> bpy.types.Object | None:
    """The character that a bake puts the performance on: the active mesh if it has sliders.

    The scene's own face is none: a bake makes it the person who was captured. Nor is the face that
    was baked from the clip while the scene's is another clip's: it is updated.
    """
    active, face = scene_in.active(context), context.scene.mimetic.face
    if active is None or active == face or not scene_in.is_face(active):
        return None
    clip = scene_in.clip_of(context)
    mark = clips.fingerprint(clip) if clip and not native.problem() else ""
    is_clips = mark and active.mimetic.footage == mark
    return None if is_clips and face and face.mimetic.footage != mark else active


def no_update(scene: bpy.types.Scene) -> str:
    """Why the scene's own face and camera cannot take a performance."""
    face, camera = scene.mimetic.face, scene.mimetic.camera
    if scene_in.holds(scene, face) and (reason := writable.no_shapes(face)):
        return reason
    if scene_in.holds(scene, camera):
        return writable.no_lens(camera)
    return ""


def no_head_take(context) -> str:
    """Why there is no head motion to key."""
    return scene_in.no_take(context, "Capture, or Head Only")


def no_head_target(context) -> str:
    """Why the head's motion cannot be keyed on what is chosen."""
    if reason := no_head_take(context):
        return reason
    settings = context.scene.mimetic
    target = settings.head.target
    if not scene_in.holds(context.scene, target):
        return "Choose the object, empty or armature that the head shall move"
    if reason := writable.no_motion(target):
        return reason
    if target.type != "ARMATURE":
        return ""
    if target.mode == "EDIT":
        return iface_("Leave {name}'s edit mode first").format(name=target.name)
    for name in (settings.head.bone, settings.head.neck):
        if name and name not in target.pose.bones:
            return iface_("{name} has no bone {bone}; choose one of its bones").format(
                name=target.name, bone=name
            )
    if settings.head.bone and settings.head.bone == settings.head.neck:
        return "Head and neck are the same bone; choose another or leave the neck empty"
    return "" if settings.head.bone else rigs.no_whole_motion(target)


def no_curves(context) -> str:
    """Why the face's curves cannot be edited."""
    if reason := scene_in.no_sliders(context):
        return reason
    face = scene_in.face_of(context)
    if reason := writable.no_sliders(face):
        return reason
    if not (curves := face_curves.of(face)):
        if face_curves.are_in_strips(face):
            return "The face's curves lie in strips: open one in the NLA first (Tab)"
        return "The face has no curves yet: press Bake first"
    libraries = {row.curve.id_data.library for row in curves} - {None}
    return "The face's action is another file's" if libraries else ""


def take_owner(context) -> bpy.types.Object | None:
    """Whose takes buttons mean: the active character's, if it has any, else the face's."""
    active = scene_in.active(context)
    if active is not None and len(active.mimetic.takes):
        return active
    return scene_in.face_of(context)


def no_take_list(context) -> str:
    """Why there are no takes to play."""
    if reason := scene_in.no_start():
        return reason
    obj = take_owner(context)
    if obj is None or not len(obj.mimetic.takes):
        return "No take yet: press Bake first"
    if obj.mode == "EDIT":
        return iface_("Leave {name}'s edit mode first").format(name=obj.name)
    return writable.no_motion(obj)


def no_controls(context) -> str:
    """Why the active object has no controls of its own to drive."""
    character = scene_in.active(context)
    if reason := scene_in.no_start():
        return reason
    is_rig = character is not None and character.type == "ARMATURE"
    if is_rig:
        reason = face_bones.no_face(context.scene, character) or writable.no_motion(character)
    else:
        reason = own_keys.no_own_keys(character)
    if reason:
        return reason
    if character.mode == "EDIT":
        return iface_("Leave {name}'s edit mode first").format(name=character.name)
    return "" if is_rig else writable.no_sliders(character)


def no_control_table(context) -> str:
    """Why there is no table of controls to change or keep."""
    if reason := no_controls(context):
        return reason
    return "" if len(scene_in.active(context).mimetic.controls) else "Press Fit Controls first"


def no_controls_bake(context) -> str:
    """Why no performance can be put on the active object's own controls."""
    return no_controls(context) or scene_in.no_take(context, "Capture")


def no_expression(context) -> str:
    """Why there is no expression to use."""
    if reason := scene_in.no_start():
        return reason
    asset = getattr(context, "asset", None)
    if asset is not None:
        is_one = asset.id_type == "ACTION"
        return (
            ""
            if is_one
            else iface_("{name} is no expression: choose one that was kept").format(name=asset.name)
        )
    if not any(map(expressions.is_expression, bpy.data.actions)):
        return "There is no expression yet: press Keep Expression or Load Library"
    return ""


def no_expression_on_face(context) -> str:
    """Why no expression can be put on the face."""
    if reason := scene_in.no_sliders(context) or no_expression(context):
        return reason
    face = scene_in.face_of(context)
    return writable.no_sliders(face) or control_object.no_values(face)


def no_expression_strips(context) -> str:
    """Why there is nothing to compose."""
    if reason := no_rest(context):
        return reason
    if not expression_strips.strips_of(scene_in.face_of(context)):
        return "Press Add Expression Strip first: the face has none"
    return ""


def no_added_controls(context) -> str:
    """Why the face cannot be given a control object."""
    if reason := scene_in.no_sliders(context):
        return reason
    face = scene_in.face_of(context)
    if not scene_in.is_face(face):
        return iface_("{name} has no sliders: press Attach Muscles").format(name=face.name)
    if reason := control_object.no_controls(face):
        return reason
    animation = face.data.shape_keys.animation_data
    if animation is not None and (animation.action or animation.nla_tracks):
        return iface_("{name}'s shape keys have curves: Bake to Control Object instead").format(
            name=face.name
        )
    return ""


def no_rest(context) -> str:
    """Why the face's sliders cannot be put to 0, or to anything else."""
    if reason := scene_in.no_sliders(context):
        return reason
    face = scene_in.face_of(context)
    return writable.no_sliders(face) or control_object.no_values(face)


def no_export(context) -> str:
    """Why the face cannot be written as glTF, whose exporter reads curves of shape keys alone."""
    if reason := scene_in.no_visible_face(context):
        return reason
    return control_object.no_values(scene_in.face_of(context))
