# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders in degrees for eyes that five shape keys each turn."""

from __future__ import annotations

import bpy

from .. import native
from . import by_hand

SIDES = ("L", "R")
TURNS = ("eye_down", "eye_left", "eye_down_down", "eye_down_left", "eye_left_left")


def remember(face: bpy.types.Object, performance) -> None:
    """Keeps on the face how its upper lids go along with the eyes; 0 where it has no gaze."""
    following = performance.lid_following
    rows = native.array(following).reshape(-1) if following is not None else (0.0,) * 4
    face.mimetic.lid_following = tuple(rows)


def turns(face: bpy.types.Object) -> bool:
    """Whether the face has the shapes that turn its eyes."""
    return bool(_keys(face, "L")) and bool(_keys(face, "R"))


def angles(face: bpy.types.Object, side: str) -> tuple[float, float]:
    """Yaw and pitch of an eye, radians to the subject's left and up; 0 for a face without."""
    keys = _keys(face, side)
    if not keys or native.problem():
        return 0.0, 0.0
    values = {shape: key.value for shape, key in keys.items()}
    return native.gaze_shapes().angles_of_keys(side, values)


def set_angles(face: bpy.types.Object, side: str, yaw: float, pitch: float) -> None:
    """Turns an eye, and its upper lid goes along; a face without the shapes stays as it is."""
    keys = _keys(face, side)
    if not keys or native.problem():
        return
    before = angles(face, side)[1]
    for shape, value in native.gaze_shapes().turned_keys(side, yaw, pitch).items():
        keys[shape].value = value
    first = 2 * SIDES.index(side)
    following = tuple(face.mimetic.lid_following[first : first + 2])
    entry = by_hand.entries_of(face).get(f"lid_upper.{side}")
    lid = entry and face.data.shape_keys.key_blocks.get(entry.name)
    if lid and following[0]:
        lid.value = native.gaze_shapes().carried_lid(lid.value, following, before, pitch)


def _keys(face: bpy.types.Object, side: str) -> dict[str, bpy.types.ShapeKey]:
    """The face's keys by the names of the shapes; none unless it has them all."""
    shape_keys = getattr(face.data, "shape_keys", None) if face else None
    if shape_keys is None:
        return {}
    entries = by_hand.entries_of(face)
    names = [f"{name}.{side}" for name in TURNS]
    blocks = {
        name: shape_keys.key_blocks.get(entries[name].name) for name in names if name in entries
    }
    return blocks if len(blocks) == len(names) and all(blocks.values()) else {}
