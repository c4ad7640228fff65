# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves: a new action for every take; an action that was there stays in the file."""

from __future__ import annotations

import bpy
import numpy as np

from .. import compat, native
from . import standing

LINEAR = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["LINEAR"].value
BEZIER = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["BEZIER"].value
HANDLES = bpy.types.Keyframe.bl_rna.properties["handle_left_type"].enum_items
ALIGNED, FREE = HANDLES["ALIGNED"].value, HANDLES["FREE"].value
ROTATION_PATHS = ("rotation_quaternion", "rotation_euler", "rotation_axis_angle")
CONSTANT = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["CONSTANT"].value


def key_shapes(
    face,
    take: str,
    frames,
    shapes,
    key_names: dict[str, str],
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> int:
    """Keys the values of the shapes; returns the number of curves. key_names: of each shape.

    tolerance: by how much few keys with handles may miss the values; 0 keys every frame. by_phases:
    those keys lie at the phases of events first.
    """
    keys = face.data.shape_keys
    holder = new_take(keys, f"{take} muscles")
    moving_shapes = [shape for shape in shapes if len(shape.values)]
    for shape in moving_shapes:
        path = f'key_blocks["{bpy.utils.escape_identifier(key_names[shape.name])}"].value'
        curve = compat.new_curve(holder, path, 0, shape.group)
        fill_values(curve, frames, shape.values, tolerance, by_phases)
    return len(moving_shapes)


def fill_values(
    curve: bpy.types.FCurve, frames, values, tolerance: float, by_phases: bool, unit: float = 1.0
) -> float:
    """Keys a curve by values (N) times `unit`: few keys within a tolerance of them, 0 for all.

    Returns how far few keys are from the values at most.
    """
    if tolerance > 0:
        keys = native.sparse_curves().sparse_keys(frames, values, tolerance, by_phases)
        fill_sparse(curve, keys if unit == 1 else keys.scaled(unit))
        return keys.error
    fill(curve, frames, values * unit, LINEAR)
    return 0.0


def key_motion(face, take: str, frames, channels) -> int:
    """Keys the head's motion on the object, `mimetic.rig_motion.Channels` of quaternions; returns
    the number of curves."""
    face.rotation_mode = "QUATERNION"
    holder = new_take(face, f"{take} head")
    return sum(
        key_columns(holder, path, "Head", frames, rows)
        for path, rows in (
            ("location", channels.locations),
            (channels.rotation_path, channels.rotations),
        )
    )


def key_columns(holder, data_path: str, group: str, frames, rows) -> int:
    """A curve for each column of N x C values; returns C."""
    for index, values in enumerate(rows.T):
        fill(compat.new_curve(holder, data_path, index, group), frames, values, LINEAR)
    return rows.shape[1]


def key_slider(
    holder,
    key: bpy.types.ShapeKey,
    group: str,
    frames,
    values,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> None:
    """Keys a shape key's value, instead of the curve that it has; few keys as for `key_shapes`."""
    path = key.path_from_id("value")
    clear(holder, path)
    curve = compat.new_curve(holder, path, 0, group)
    fill_values(curve, frames, values, tolerance, by_phases)


def key_rotations(holder, prefix: str, group: str, frames, channels) -> int:
    """Keys the rotations of `mimetic.rig_motion.Channels`; returns the number of curves."""
    clear_rotations(holder, prefix)
    return key_columns(holder, prefix + channels.rotation_path, group, frames, channels.rotations)


def clear_rotations(holder, prefix: str) -> None:
    """Removes curves of all rotation modes: those of others would lie beside unread.

    prefix: path of what turns, or nothing.
    """
    for path in ROTATION_PATHS:
        clear(holder, prefix + path)


def clear(holder, data_path: str) -> None:
    """Removes a property's curves."""
    for curve in [curve for curve in holder.fcurves if curve.data_path == data_path]:
        holder.fcurves.remove(curve)


def driver_paths(id_block: bpy.types.ID) -> set[str]:
    """Of what drivers set: it takes no curve."""
    animation = id_block.animation_data
    return {driver.data_path for driver in animation.drivers} if animation else set()


def put_away(id_block: bpy.types.ID) -> None:
    """Takes what moves data off it; the action stays in the file. An object goes to where it stood
    before its take."""
    compat.leave_tweak_mode(id_block)
    animation = id_block.animation_data
    if animation is not None and animation.action is not None:
        action, slot = animation.action, compat.slot_of(animation)
        action.use_fake_user = True
        animation.action = None
        if isinstance(id_block, bpy.types.Object):
            standing.put_back(id_block, action, compat.paths_of(action, slot))


def new_take(id_block: bpy.types.ID, name: str):
    """Assigns a new action and returns the holder of its curves."""
    compat.leave_tweak_mode(id_block)  # what it leads to is not the action that was assigned
    animation = id_block.animation_data
    if animation is not None and animation.action is not None:
        animation.action.use_fake_user = True  # the take before, or the user's own work
    compat.new_action(name, id_block)
    return compat.curves(id_block)


def continued_take(id_block: bpy.types.ID, name: str):
    """As `new_take`, but with a copy of all curves that were there, so that other motion stays."""
    compat.leave_tweak_mode(id_block)
    animation = id_block.animation_data
    if animation is None or animation.action is None:
        return new_take(id_block, name)
    before = animation.action
    before.use_fake_user = True
    compat.assign_action(id_block, before.copy(), name)
    return compat.curves(id_block)


def fill(curve: bpy.types.FCurve, frames, values, interpolation: int) -> None:
    """Keys a curve densely; frames and values: N each."""
    points = curve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.column_stack([frames, values]).astype(np.float32).reshape(-1))
    points.foreach_set("interpolation", np.full(len(frames), interpolation, dtype=np.int32))
    curve.update()


def fill_sparse(curve: bpy.types.FCurve, keys) -> None:
    """Keys a curve by few keys with handles, instead of those that it has."""
    points = curve.keyframe_points
    points.clear()
    points.add(len(keys.points))
    count = len(points)
    points.foreach_set("interpolation", np.full(count, BEZIER, dtype=np.int32))
    for side in ("left", "right"):
        points.foreach_set(f"handle_{side}_type", np.full(count, ALIGNED, dtype=np.int32))
    for name, rows in (
        ("co", keys.points),
        ("handle_left", keys.left),
        ("handle_right", keys.right),
    ):
        points.foreach_set(name, np.asarray(rows, dtype=np.float32).reshape(-1))
    curve.update()
