# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders in degrees for eyes that five shape keys each turn."""

from __future__ import annotations

import bpy

from .. import native
from . import by_hand

SIDES = ("L", "R")
TURNS = ("eye_down", "eye_left", "eye_down_down", "eye_down_left", "eye_left_left")


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
    """Turns an eye; a face without the shapes stays as it is."""
    keys = _keys(face, side)
    if not keys or native.problem():
        return
    for shape, value in native.gaze_shapes().turned_keys(side, yaw, pitch).items():
        keys[shape].value = value


def _keys(face: bpy.types.Object, side: str) -> dict[str, bpy.types.ShapeKey]:
    """The face's keys by the names of the shapes; none unless it has them all."""
    shape_keys = getattr(face.data, "shape_keys", None) if face else None
    if shape_keys is None:
        return {}
    entries = by_hand.entries_of(face)
    names = [f"{name}.{side}" for name in TURNS]
    found = {
        name: shape_keys.key_blocks.get(entries[name].name) for name in names if name in entries
    }
    return found if len(found) == len(names) and all(found.values()) else {}
