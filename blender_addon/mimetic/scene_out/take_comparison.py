# SPDX-License-Identifier: GPL-3.0-or-later
"""Two takes side by side: a copy of the face beside it plays the other at the same time."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_
from mathutils import Vector

from .. import native, world
from . import control_object, framed, take_list

BESIDE = 0.25  # metres


def no_copy(obj: bpy.types.Object) -> str:
    """Why a face cannot stand beside itself."""
    rig = next((m.object for m in obj.modifiers if m.type == "ARMATURE" and m.object), None)
    return (
        iface_("{armature} deforms {name}: duplicate the whole character instead").format(
            armature=rig.name, name=obj.name
        )
        if rig
        else ""
    )


def stand_beside(scene: bpy.types.Scene, face: bpy.types.Object, row) -> bpy.types.Object:
    """A copy of the face, to its right as the camera sees it, that plays a take; the face itself
    goes on as it does, and 3D views show both. Raises InvalidInput, and changes nothing then."""
    if reason := no_copy(face) or take_list.no_play(face, row):
        raise native.invalid_input(reason)
    twin = face.copy()
    twin.name = f"{face.name} {row.name}"
    twin.data = face.data.copy()
    mover = twin
    if (control := control_object.of(face)) is not None:
        own = _own_control(control, face, twin)
        mover = own if twin.parent == own else twin
    for new in {twin, mover, twin.mimetic.control_object} - {None}:
        for collection in face.users_collection:
            if new.name not in collection.objects:
                collection.objects.link(new)
    mover.delta_location = Vector(mover.delta_location) + _aside(scene)
    take_list.play(twin, twin.mimetic.takes[row.name])
    framed.frame(_camera(scene), [face, twin])
    return twin


def _own_control(control, face, twin) -> bpy.types.Object:
    """A copy of the control object that drives the copied face."""
    own = control.copy()
    twin.mimetic.control_object = own
    _hold(twin, face, {control: own})
    _hold(own, control, {face: twin})
    animation = twin.data.shape_keys.animation_data
    for curve in animation.drivers if animation else ():
        for variable in curve.driver.variables:
            for target in variable.targets:
                if target.id == control:
                    target.id = own
    for bone in own.pose.bones:
        for constraint in bone.constraints:
            if getattr(constraint, "target", None) == control:
                constraint.target = own
    return own


def _hold(copied: bpy.types.Object, original: bpy.types.Object, twins: dict) -> None:
    """Gives a copy the twin of its parent, on which it stands as the original does."""
    if original.parent in twins:
        matrix = original.matrix_parent_inverse.copy()
        copied.parent = twins[original.parent]
        copied.parent_type, copied.parent_bone = original.parent_type, original.parent_bone
        copied.matrix_parent_inverse = matrix


def _aside(scene: bpy.types.Scene) -> Vector:
    camera = _camera(scene)
    right = Vector((1, 0, 0))
    if camera is not None:
        right = world.matrix(camera).to_3x3().col[0].normalized()
    return right * (BESIDE / (scene.unit_settings.scale_length or 1.0))


def _camera(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The clip's, where the scene has it."""
    camera = scene.mimetic.camera
    return camera if camera is not None and camera.name in scene.objects else None
