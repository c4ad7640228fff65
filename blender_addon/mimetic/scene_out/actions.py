# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves: a new action for every take; an action that was there stays in the file."""

from __future__ import annotations

import bpy
import numpy as np

from .. import compat

LINEAR = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["LINEAR"].value
CONSTANT = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["CONSTANT"].value


def key_shapes(face, take: str, frames, shapes) -> int:
    """Keys the values of the shapes; returns the number of curves."""
    keys = face.data.shape_keys
    holder = new_take(keys, f"{take} muscles")
    for shape in shapes:
        path = f'key_blocks["{bpy.utils.escape_identifier(shape.name)}"].value'
        fill(compat.new_curve(holder, path, 0, shape.group), frames, shape.values, LINEAR)
    return len(shapes)


def key_motion(face, take: str, frames, motion) -> int:
    """Keys the head's motion on the object; returns the number of curves."""
    face.rotation_mode = "QUATERNION"
    holder = new_take(face, f"{take} head")
    for path, columns in (
        ("location", motion.locations.T),
        ("rotation_quaternion", motion.quaternions.T),
    ):
        for index, values in enumerate(columns):
            fill(compat.new_curve(holder, path, index, "Head"), frames, values, LINEAR)
    return 7


def new_take(id_block: bpy.types.ID, name: str):
    """Assigns a new action and returns the holder of its curves."""
    animation = id_block.animation_data
    if animation is not None and animation.action is not None:
        animation.action.use_fake_user = True  # the take before, or the user's own work
    compat.new_action(name, id_block)
    return compat.curves(id_block)


def fill(curve: bpy.types.FCurve, frames, values, interpolation: int) -> None:
    """Keys a curve densely; frames and values: N each."""
    points = curve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.column_stack([frames, values]).astype(np.float32).reshape(-1))
    points.foreach_set("interpolation", np.full(len(frames), interpolation, dtype=np.int32))
    curve.update()
