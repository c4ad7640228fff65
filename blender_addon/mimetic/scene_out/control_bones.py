# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of a control object: where they stand, what they look like, their properties."""

from __future__ import annotations

from contextlib import contextmanager
from math import cos, pi, sin

import bpy
from mathutils import Vector

from .. import native
from .switched_on import switched_on

NEAR = 5e-4  # metres: bones are moved if they shall stand farther off
LENGTHS = {"head": 0.1, "jaw": 0.012, "eye": 0.03, "gaze": 0.03}
USUAL_LENGTH = 0.007
PALETTES = {".L": "THEME04", ".R": "THEME01", "": "THEME09"}  # blue, red, yellow
UP = Vector((0, 0, 1))


def names_of(layout) -> set[str]:
    return {bone for bone, *_ in _rows(layout)}


def path_of(channel) -> str:
    """Where a `mimetic.character.control_object.Channel` is animated on its control object."""
    bone = f'pose.bones["{bpy.utils.escape_identifier(channel.bone)}"]'
    is_place = channel.path == native.control_object().LOCATION
    return f"{bone}.location" if is_place else f'{bone}["{channel.path}"]'


def ensure(control: bpy.types.Object, layout) -> None:
    """Adds missing bones, moves those that stand elsewhere, and gives them what can be animated."""
    rows = _rows(layout)
    bones = control.data.bones
    if any(
        name not in bones or (Vector(head) - bones[name].head_local).length > NEAR
        for name, _, head, _ in rows
    ):
        with _editing(control) as edit_bones:
            for name, parent, head, tail in rows:
                bone = edit_bones.get(name) or edit_bones.new(name)
                bone.head, bone.tail = head, tail
                bone.align_roll(UP)
                bone.parent = edit_bones.get(parent)
                bone.use_deform = False
    _collect(control.data, layout)
    by_bone: dict[str, list] = {}
    for channel in layout.channels:
        by_bone.setdefault(channel.bone, []).append(channel)
    for name, *_ in rows:
        _dress(control.pose.bones[name], by_bone.get(name, []))
    _aim(control, layout)


def _rows(layout) -> list[tuple]:
    """Name, parent, head and tail of each bone, parents first."""
    parts = native.control_object()
    rows = [(parts.HEAD, "", (0, 0, 0), (0, LENGTHS["head"], 0))]
    names = list(layout.places)
    names.sort(key=lambda name: _depth(layout.parents, name))
    for name in names:
        head = Vector([float(x) for x in layout.places[name]])
        length = LENGTHS.get(name, USUAL_LENGTH)
        rows.append((name, layout.parents[name], head, head + Vector((0, length, 0))))
    if layout.eyes:
        far = Vector((0, -parts.GAZE_DISTANCE, 0))
        eyes = {side: Vector([float(x) for x in place]) for side, place in layout.eyes.items()}
        target = 0.5 * (eyes["L"] + eyes["R"]) + far
        length = Vector((0, LENGTHS["gaze"], 0))
        rows.append((parts.GAZE_BONE, parts.HEAD, target, target + length))
        for side, place in eyes.items():
            tail = place - Vector((0, LENGTHS["eye"], 0))
            rows.append((f"eye.{side}", parts.HEAD, place, tail))
            aim = place + far
            rows.append((f"{parts.GAZE_BONE}.{side}", parts.GAZE_BONE, aim, aim + length))
    return rows


def _depth(parents: dict[str, str], name: str) -> int:
    return 1 + _depth(parents, parents[name]) if name in parents else 0


@contextmanager
def _editing(control: bpy.types.Object):
    """The armature's bones to be edited; mode and active object are as before afterwards."""
    view_layer = bpy.context.view_layer
    view_layer.update()
    active = view_layer.objects.active
    mode = active.mode if active is not None else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    with switched_on(bpy.context.scene, control):
        view_layer.objects.active = control
        bpy.ops.object.mode_set(mode="EDIT")
        try:
            yield control.data.edit_bones
        finally:
            bpy.ops.object.mode_set(mode="OBJECT")
            view_layer.objects.active = active
            if mode != "OBJECT":
                bpy.ops.object.mode_set(mode=mode)


def _collect(armature: bpy.types.Armature, layout) -> None:
    parts = native.control_object()
    groups = {channel.bone: channel.group for channel in layout.channels}
    strengths = {channel.bone for channel in layout.channels if channel.path == parts.STRENGTH}
    for bone in armature.bones:
        name = "Groups" if bone.name in strengths else groups.get(bone.name, "")
        if not name:
            name = "Head" if bone.name == parts.HEAD else "Gaze"
        collection = armature.collections.get(name) or armature.collections.new(name)
        collection.assign(bone)


def _dress(bone: bpy.types.PoseBone, channels: list) -> None:
    parts = native.control_object()
    side = bone.name[-2:] if bone.name[-2:] in (".L", ".R") else ""
    bone.color.palette = PALETTES[side]
    moved_axes = {channel.index for channel in channels if channel.path == parts.LOCATION}
    is_target = bone.name.split(".")[0] == parts.GAZE_BONE
    is_head = bone.name == parts.HEAD
    bone.rotation_mode = "QUATERNION" if is_head else "XYZ"
    bone.custom_shape = _widget(bone, parts, bool(channels) and channels[0].path == parts.STRENGTH)
    if not is_head:
        bone.lock_rotation = (True,) * 3
        bone.lock_scale = (True,) * 3
        bone.lock_location = tuple(not is_target and axis not in moved_axes for axis in range(3))
    if moved_axes:
        _limit(bone, channels)
    for channel in channels:
        if channel.path != parts.LOCATION:
            _give_property(bone, channel)


def _give_property(bone: bpy.types.PoseBone, channel) -> None:
    if channel.path not in bone:
        bone[channel.path] = 0.0
    bone.id_properties_ui(channel.path).update(
        min=channel.lowest,
        max=channel.highest,
        soft_min=channel.lowest,
        soft_max=channel.highest,
        default=0.0,
        description=channel.tip,
    )
    bone.property_overridable_library_set(f'["{channel.path}"]', True)


def _limit(bone: bpy.types.PoseBone, channels: list) -> None:
    limit = bone.constraints.get("Range") or bone.constraints.new("LIMIT_LOCATION")
    limit.name, limit.owner_space, limit.use_transform_limit = "Range", "LOCAL", True
    for channel in channels:
        ends = sorted((channel.lowest * channel.unit, channel.highest * channel.unit))
        axis = "xyz"[channel.index]
        for end, value in zip(("min", "max"), ends, strict=True):
            setattr(limit, f"use_{end}_{axis}", True)
            setattr(limit, f"{end}_{axis}", value)


def _aim(control: bpy.types.Object, layout) -> None:
    """Eyes look at their targets, without torsion about the line of sight."""
    target = native.control_object().GAZE_BONE
    for side in layout.eyes:
        bone = control.pose.bones[f"eye.{side}"]
        track = bone.constraints.get("Gaze") or bone.constraints.new("TRACK_TO")
        track.name, track.target, track.subtarget = "Gaze", control, f"{target}.{side}"
        track.track_axis, track.up_axis, track.use_target_z = "TRACK_Y", "UP_Z", True


def _widget(bone: bpy.types.PoseBone, parts, is_group: bool) -> bpy.types.Object | None:
    if bone.name.split(".")[0] == "eye":
        return None
    kind = "Square" if is_group else "Circle"
    bone.custom_shape_scale_xyz = (1, 1, 1)
    bone.use_custom_shape_bone_size = True
    if bone.name == parts.HEAD:
        bone.custom_shape_translation = (0, 0, 0.13)
        bone.custom_shape_scale_xyz = (0.35,) * 3
    return _shape(kind)


def _shape(kind: str) -> bpy.types.Object:
    """An outline in the plane of the face, of half the bone's length; of this file, shared."""
    name = f"Mimetic {kind}"
    known = bpy.data.objects.get((name, None))
    if known is not None:
        return known
    count = 4 if kind == "Square" else 16
    start = pi / 4 if kind == "Square" else 0.0
    points = [
        (0.5 * cos(start + 2 * pi * i / count), 0.0, 0.5 * sin(start + 2 * pi * i / count))
        for i in range(count)
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [(i, (i + 1) % count) for i in range(count)], [])
    return bpy.data.objects.new(name, mesh)
