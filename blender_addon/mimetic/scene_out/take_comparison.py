# SPDX-License-Identifier: GPL-3.0-or-later
"""Two takes side by side: a copy of the face beside it plays the other at the same time."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_
from mathutils import Vector

from .. import native, scene_in, world, writable
from . import bound, control_object, framed, part_keys, renamed_keys, take_list

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
    renamed_keys.follow(face)  # before names are remembered on the copy alone
    twin = face.copy()
    twin.name = f"{face.name} {row.name}"
    twin.data = face.data.copy()
    twin.mimetic.companions.clear()
    twin.mimetic.footage = ""  # or a bake of the footage might update the copy
    mover = twin
    if (control := control_object.of(face)) is not None:
        own = _own_control(control, face, twin)
        mover = own if twin.parent == own else twin
    parts = _own_parts(face, twin)
    collections = writable.collections_for(scene, face.users_collection)
    for new in {twin, mover, twin.mimetic.control_object, *parts} - {None}:
        for collection in collections:
            if not scene_in.holds(collection, new):
                collection.objects.link(new)
    aside = BESIDE * bound.units_of(scene, face) * _right(scene)
    for new in (mover, *(part for part in parts if part.parent not in (twin, *parts))):
        parent_from_world = world.space(new).to_3x3().inverted_safe()
        new.delta_location = Vector(new.delta_location) + parent_from_world @ aside
    take_list.play(twin, twin.mimetic.takes[row.name])
    framed.frame(_camera(scene), [face, twin])
    return twin


def _own_parts(face, twin) -> list[bpy.types.Object]:
    """Copies of the eyeballs, teeth and tongue that are objects of their own, which follow the
    copied face, and of what between them and the face they hang on."""
    parts = [entry.part for entry in twin.mimetic.parts if entry.part is not None]
    originals = dict.fromkeys(obj for part in parts for obj in _up_to(face, part))
    copies = {original: original.copy() for original in originals}
    for original, own in copies.items():
        _hold(own, original, {face: twin, **copies})
    for entry in twin.mimetic.parts:
        if (own := copies.get(entry.part)) is None:
            continue
        own.data = entry.part.data.copy()
        entry.part = own
        if own.data.shape_keys is not None:
            part_keys.follow(own, face, twin)
    return list(copies.values())


def _up_to(face, part) -> list[bpy.types.Object]:
    """A part, and what it hangs on below the face; the part alone if that is not the face."""
    way, above = [part], part.parent
    while above is not None and above != face:
        way.append(above)
        above = above.parent
    return way if above == face else way[:1]


def _own_control(control, face, twin) -> bpy.types.Object:
    """A copy of the control object that drives the copied face."""
    own = control.copy()
    twin.mimetic.control_object = own
    _hold(twin, face, {control: own})
    _hold(own, control, {face: twin})
    keys = twin.data.shape_keys  # none where they were applied
    animation = keys.animation_data if keys is not None else None
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


def _right(scene: bpy.types.Scene) -> Vector:
    """Of the world, as the camera sees it."""
    camera = _camera(scene)
    if camera is None:
        return Vector((1, 0, 0))
    return world.matrix(camera).to_3x3().col[0].normalized()


def _camera(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The clip's, where the scene has it."""
    camera = scene.mimetic.camera
    return camera if scene_in.holds(scene, camera) else None
