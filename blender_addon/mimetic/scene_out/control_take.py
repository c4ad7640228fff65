# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as a take of a control object: one action, named after the clip."""

from __future__ import annotations

import bpy

from .. import compat, native
from . import actions, control_bones, control_object, face, head, key_table

GAZE_GROUP, HEAD_GROUP = "Gaze", "Head"


def key_face(
    obj: bpy.types.Object, performance, take: str, frames, motion, shapes, *keys_like
) -> int:
    """A performance on the control object of its own face, which `prepare` has made sure of.

    motion: `mimetic.rig_motion.Channels` of quaternions, of the bone `head` or the object; shapes:
    `mimetic.shapes.Shape`, of which those that no bone drives (detail, contact) are keyed on the
    shape keys themselves, in Blender 4.4 and later in the same action. keys_like: tolerance of few
    keys and whether they lie at phases. Returns the number of curves.
    """
    control = control_object.of(obj)
    num_curves = key(obj, performance, take, frames, *keys_like)
    if control_object.carries(obj):
        holder = compat.curves(control)
        prefix = f'pose.bones["{native.control_object().HEAD}"].'
        for path, rows in (
            ("location", motion.locations),
            (motion.rotation_path, motion.rotations),
        ):
            num_curves += actions.key_columns(holder, prefix + path, HEAD_GROUP, frames, rows)
    else:
        num_curves += actions.key_motion(obj, take, frames, motion)
    return num_curves + _key_rest(obj, control, take, frames, shapes)


def prepare(scene: bpy.types.Scene, obj: bpy.types.Object, performance) -> bool:
    """Before a performance is keyed on the control object of its own face: one that is there is
    brought up to date, else one is made. Says whether it was made."""
    is_new = control_object.of(obj) is None
    put_keys_away(obj, performance)
    control_object.ensure(scene, obj)
    return is_new


def key(
    obj: bpy.types.Object, performance, take: str, frames, tolerance=0.0, by_phases=False
) -> int:
    """The performance's muscles, jaw, lids and gaze on the face's control object, in a new action;
    returns the number of curves."""
    parts = native.control_object()
    channels, kind = control_object.channels_of(obj)
    holder = actions.new_take(control_object.of(obj), take)
    values = parts.channel_values(performance, kind)
    moving_channels = [channel for channel in channels if channel.shape in values]
    for channel in moving_channels:
        path = control_bones.path_of(channel)
        curve = compat.new_curve(holder, path, channel.index, channel.group)
        like = tolerance, by_phases, channel.unit
        actions.fill_values(curve, frames, values[channel.shape], *like)
    num_curves = len(moving_channels)
    for bone, rows in (parts.gaze_locations(performance) if kind else {}).items():
        path = f'pose.bones["{bone}"].location'
        for axis, offsets in enumerate(rows.T):
            curve = compat.new_curve(holder, path, axis, GAZE_GROUP)
            shares = offsets / parts.GAZE_DISTANCE
            actions.fill_values(curve, frames, shares, tolerance, by_phases, parts.GAZE_DISTANCE)
            num_curves += 1
    return num_curves


def put_keys_away(obj: bpy.types.Object, performance) -> None:
    """Before a face gets its control object: takes on the shape keys and, of a face that it shall
    move, on the object play no longer; they stay in the file.

    Raises InvalidInput, and changes nothing, where the performance cannot be keyed on it.
    """
    if control_object.channels_of(obj)[1]:
        native.control_object().gaze_locations(performance)
    if control_object.of(obj) is not None:
        return
    actions.put_away(obj.data.shape_keys)
    if not len(obj.mimetic.landmarks):
        actions.put_away(obj)


def key_head_bone(
    scene, performance, take: str, control: bpy.types.Object, footage, units: float
) -> int:
    """The head's motion on the bone `head`, in the take that was just keyed; units: of the world,
    per metre."""
    muscles = control.animation_data.action
    scale = units * head.metres_of(scene, None)
    bone = native.control_object().HEAD
    target = head.Target(control.name, bone, translation_scale=scale)
    summary = head.bake(scene, performance, take, target, footage)
    bpy.data.actions.remove(muscles)  # a copy of it is keyed
    control.animation_data.action.name = take
    return summary.num_curves


def join(control: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Puts what moves an object into the control object's own action, where actions can do that."""
    take, own = control.animation_data.action, obj.animation_data.action
    sources = list(compat.curves(obj).fcurves)
    if not compat.ACTIONS_HAVE_SLOTS:
        return
    compat.join_action(take, obj)
    holder = compat.curves(obj)
    for source in sources:
        group = source.group.name if source.group else HEAD_GROUP
        curve = compat.new_curve(holder, source.data_path, source.array_index, group)
        key_table.write(curve, key_table.read(source))
        curve.extrapolation = source.extrapolation
    for name, note in own.items():
        take[name] = note
    bpy.data.actions.remove(own)


def _key_rest(obj: bpy.types.Object, control, take: str, frames, shapes) -> int:
    """Shapes that no bone drives, on the shape keys."""
    keys = obj.data.shape_keys
    actions.put_away(keys)
    parts = native.control_object()
    driven_shapes = parts.covered(*control_object.channels_of(obj))
    shapes = [shape for shape in shapes if len(shape.values) and shape.name not in driven_shapes]
    if not shapes:
        return 0
    if not compat.join_action(control.animation_data.action, keys):
        compat.new_action(f"{take} shapes", keys)
    holder, names = compat.curves(keys), face.key_names(obj)
    for shape in shapes:
        path = f'key_blocks["{bpy.utils.escape_identifier(names[shape.name])}"].value'
        curve = compat.new_curve(holder, path, 0, shape.group)
        actions.fill(curve, frames, shape.values, actions.LINEAR)
    return len(shapes)
