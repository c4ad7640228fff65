# SPDX-License-Identifier: GPL-3.0-or-later
"""The control object of a face: an armature whose bones drive the face's shape keys.

It stands where the face does. A face that nothing else moves hangs on its bone `head`; a head that
a rig or a parent moves carries it along instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix, Vector

from .. import native, world, writable
from . import bound, by_hand, contact, control_bones, control_drivers, movers, own_keys


@dataclass(frozen=True)
class Layout:
    """What bones a face gets, from what sliders it has."""

    channels: list  # of mimetic.character.control_object.Channel
    kind: str  # of the gaze
    parents: dict[str, str]
    places: dict  # of bones, metres in the character frame
    eyes: dict  # side -> place

    def bones(self) -> set[str]:
        return control_bones.names_of(self)


def of(face: bpy.types.Object | None) -> bpy.types.Object | None:
    """The control object of a face, None where it has none or where it is gone."""
    control = face.mimetic.control_object if face is not None else None
    return control if control is not None and control.users_scene else None


def other_face(face: bpy.types.Object) -> bpy.types.Object | None:
    """Another face that hangs on the same control object, as a duplicate of the mesh alone does."""
    if (control := of(face)) is None:
        return None
    return next(
        (
            obj
            for obj in bpy.data.objects
            if obj != face and obj.users_scene and obj.mimetic.control_object == control
        ),
        None,
    )


def is_lost(face: bpy.types.Object) -> bool:
    """Whether the face's control object was deleted."""
    return face.mimetic.has_controls and of(face) is None


def no_controls(face: bpy.types.Object) -> str:
    """Why a face cannot have a control object."""
    if reason := writable.no_shapes(face):
        return reason
    if face.mode == "EDIT":
        return iface_("Leave {name}'s edit mode first").format(name=face.name)
    others = own_keys.driven_keys(face.data.shape_keys) - control_drivers.keys_driven(face)
    names = set(by_hand.keys_now(face).values()) & others
    if names:
        return iface_("Drivers of your own set {names} of {face}").format(
            names=", ".join(sorted(names)[:3]), face=face.name
        )
    return ""


def no_keys(face: bpy.types.Object | None) -> str:
    """Why curves on a face's shape keys would not be seen."""
    control = of(face)
    if control is None:
        return ""
    return iface_(
        "{face} is driven by {control}: bake to Control Object, or take it "
        "away first (Remove Control Object)"
    ).format(face=face.name, control=control.name)


def no_bake(face: bpy.types.Object | None, use_controls: bool) -> str:
    """Why a bake cannot go where it is meant to, on a control object or on shape keys."""
    if face is None or face.data.shape_keys is None:
        return ""
    return no_controls(face) if use_controls else no_keys(face)


def no_values(face: bpy.types.Object | None) -> str:
    """Why what is put on a face's shape keys would not be seen, or would be lost."""
    control = of(face)
    if control is None:
        return ""
    return iface_(
        "{face} is driven by {control}: pose that, or Remove Control Object first"
    ).format(face=face.name, control=control.name)


def forget_lost(face: bpy.types.Object | None) -> str:
    """Frees the shape keys of a face whose control object was deleted; says so, for a message."""
    if face is None or not is_lost(face):
        return ""
    remove(face)
    return rpt_("{face}'s control object was deleted: its shape keys move by themselves").format(
        face=face.name
    )


def ensure(scene: bpy.types.Scene, face: bpy.types.Object) -> bpy.types.Object:
    """Gives a face its control object, or brings the one that it has up to date.

    What its bones were set to, their curves and constraints stay. Raises InvalidInput.
    """
    writable.check(no_controls(face))
    layout = layout_of(scene, face)
    control = of(face)
    is_new = control is None
    if is_new:
        if is_lost(face):
            remove(face)
        name = f"{face.name} Controls"
        control = bpy.data.objects.new(name, bpy.data.armatures.new(name))
        for collection in writable.collections_for(scene, face.users_collection):
            collection.objects.link(control)
        control.show_in_front = True
        face.mimetic.control_object, face.mimetic.has_controls = control, True
        _join(scene, face, control)
    control_bones.ensure(control, layout)
    if is_new and face.parent == control:
        _hang(face, control)
    control_drivers.drive(face, control, layout)
    return control


def remove(face: bpy.types.Object) -> None:
    """Takes the control object away; the face stays as it looks, and where it stands. A control
    object that another face has too goes on driving that."""
    control_drivers.release(face)
    # One that was deleted too (X): out of every scene, it goes on moving what hangs on it
    control = face.mimetic.control_object
    if control is not None and face.parent == control:
        stands = world.matrix(face)
        face.parent, face.parent_type, face.parent_bone = None, "OBJECT", ""
        face.matrix_parent_inverse = Matrix.Identity(4)
        face.matrix_world = stands
    if of(face) is not None and other_face(face) is None:
        _delete(control)
    face.mimetic.control_object, face.mimetic.has_controls = None, False


def _delete(control: bpy.types.Object) -> None:
    armature = control.data
    bpy.data.objects.remove(control)
    if not armature.users:
        bpy.data.armatures.remove(armature)


def layout_of(scene: bpy.types.Scene, face: bpy.types.Object) -> Layout:
    """The bones for the face's sliders as they are now."""
    parts = native.control_object()
    channels, kind = channels_of(face)
    names = by_hand.keys_now(face)
    blocks = face.data.shape_keys.key_blocks
    matrix = native.array(Matrix(bound.object_from_character(scene, face).tolist()).inverted())
    rest = contact.points_of(face.data.shape_keys.reference_key).astype(np.float64)
    needed = parts.covered(channels, kind)
    fields = {
        shape: (contact.points_of(blocks[names[shape]]) - rest) @ matrix[:3, :3].T
        for shape in needed
        if shape in names
    }
    points = rest @ matrix[:3, :3].T + matrix[:3, 3]
    places = parts.places_of(channels, points, fields)
    eyes = parts.eye_centres(kind, points, fields)
    return Layout(channels, kind, parts.parents_of(channels), places, eyes)


def channels_of(face: bpy.types.Object) -> tuple[list, str]:
    """What drives the face's sliders, `mimetic.character.control_object.Channel`; and its gaze."""
    parts = native.control_object()
    names = by_hand.keys_now(face)
    sliders = [_slider(entry) for entry in face.mimetic.shapes if entry.shape in names]
    groups = [_slider(entry) for entry in face.mimetic.groups if entry.shape in names]
    kind = native.gaze_shapes().gaze_kind([slider.shape for slider in sliders])
    return parts.channels_of(sliders, groups), kind


def carries(face: bpy.types.Object) -> bool:
    """Whether the face hangs on its control object, and moves with its bone `head`."""
    control = of(face)
    return control is not None and face.parent == control


def head_space(face: bpy.types.Object) -> Matrix:
    """World from the space of the curves that move the face's head: of its control object's bone
    `head`, which lies in that as the armature does, or of the object."""
    return world.matrix(of(face)) if carries(face) else world.space(face)


def head_mover(face: bpy.types.Object) -> str:
    """Name of what is animated and moves that space, or the empty string."""
    control = of(face)
    if not carries(face):
        return movers.animated_mover(face)
    return control.name if movers.is_animated(control) else movers.animated_mover(control)


def _slider(entry):
    group = entry.group
    return native.control_object().Slider(entry.shape, group, entry.lowest, entry.highest)


def _join(scene, face: bpy.types.Object, control: bpy.types.Object) -> None:
    """Which of the two moves the other."""
    is_ours = not len(face.mimetic.landmarks)
    if is_ours and not bound.moved_by(face) and not _has_curves(face):
        control.matrix_world = world.matrix(face)
        face.parent = control
        return
    control.parent = face
    control.matrix_parent_inverse = Matrix.Identity(4)
    control.matrix_basis = Matrix(bound.object_from_character(scene, face).tolist())


def _has_curves(face: bpy.types.Object) -> bool:
    return face.animation_data is not None and face.animation_data.action is not None


def _hang(face: bpy.types.Object, control: bpy.types.Object) -> None:
    """On the bone `head`, so that the face stands as the armature does while that is at rest."""
    bone = control.data.bones[native.control_object().HEAD]
    face.parent_type, face.parent_bone = "BONE", bone.name
    tail = Matrix.Translation(Vector((0, bone.length, 0)))
    face.matrix_parent_inverse = (bone.matrix_local @ tail).inverted()
    face.matrix_basis = Matrix.Identity(4)
