# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the bones of a rig's face, by what the mesh does when they move.

The mesh has muscles; how it follows each bone is measured by moving the bone a little and
evaluating the rig, constraints, drivers and all, with every bone at rest (`rest_pose`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Quaternion

from .. import compat, native, scene_in, world, writable
from . import actions, baked_curves, eye_bones, head, own_controls, own_keys, rest_pose, rigs
from .motion_keys import MotionKeys

NECK_SHARE = 0.3  # of the head's turns
STEP = 0.3  # of a channel's value, to both sides


def deformed_face(scene: bpy.types.Scene, armature: bpy.types.Object) -> bpy.types.Object | None:
    """The mesh with muscles that an armature deforms."""
    for obj in scene.objects:
        if scene_in.is_face(obj) and any(
            modifier.type == "ARMATURE" and modifier.object == armature
            for modifier in obj.modifiers
        ):
            return obj
    return None


def no_face(scene: bpy.types.Scene, armature: bpy.types.Object) -> str:
    """Why a rig's face bones cannot play a performance, or nothing."""
    if deformed_face(scene, armature) is None:
        return iface_(
            "{name} deforms no mesh with muscles: attach muscles to its head "
            "first, so that what the bones should do is known"
        ).format(name=armature.name)
    if not channels(armature):
        return iface_("{name} has no bones of a face that are free to move").format(
            name=armature.name
        )
    return ""


def channels(armature: bpy.types.Object) -> list:
    """`mimetic.retarget.BoneChannel`s of the face's bones and then of the eyes', but for those that
    drivers set."""
    package = native.bone_channels()
    driven = actions.driver_paths(armature)
    names = [
        bone.name
        for bone in armature.pose.bones
        if not any(path.startswith(bone.path_from_id()) for path in driven)
    ]
    own = []
    for name in package.face_bones(names):
        bone = armature.pose.bones[name]
        locks = tuple(bone.lock_location), bone.lock_rotation[0]
        own += package.channels_of(name, _can_move(bone), *locks)
    for name in package.eye_bones(names):
        bone = armature.pose.bones[name]
        locks = tuple(bone.lock_location), tuple(bone.lock_rotation)
        own += package.eye_channels_of(name, _can_move(bone), *locks)
    return own


def _can_move(bone: bpy.types.PoseBone) -> bool:
    return not (bone.bone.use_connect and bone.bone.parent)


def surface(scene: bpy.types.Scene, armature: bpy.types.Object):
    """A `mimetic.retarget.ControlSurface`: channels of bones by their measured responses, those
    that turn the eyes by what the eyeballs do."""
    face = deformed_face(scene, armature)
    every = channels(armature)
    own = [channel for channel in every if not channel.is_of_eye]
    plain, eyeballs = own_keys.surface(face), eye_bones.Eyeballs(face)
    eyes = [channel for channel in every if channel.is_of_eye]
    gaze, carried = _gaze(scene, armature, face, eyes, eyeballs)
    responses = _responses(armature, face, own)
    sources = plain.sources.copy()
    for side in set(eyeballs.sides) - set(gaze.undriven()):
        sources[:, eyeballs.vertices(side)] = 0.0
    return replace(
        plain,
        control_names=[channel.name for channel in own],
        controls=responses,
        control_range=_reaches(armature, face, own, responses),
        source_names=[*plain.source_names, *gaze.names],
        sources=np.concatenate([sources, -carried]),
        source_range=np.concatenate([plain.source_range, gaze.ranges]),
        # What bones take along within the head is as its weights chance to be
        heeds_hidden=False,
        gaze=gaze if gaze.channels else None,
    )


def ranges(armature: bpy.types.Object) -> dict[str, list[float]]:
    """Least and greatest value of each channel of the face's bones, by name."""
    return {channel.name: list(channel.range) for channel in channels(armature)}


def play(
    scene: bpy.types.Scene, performance, armature: bpy.types.Object, preset: str | None = None
):
    """`mimetic.retarget.PlayedControls` of the rig's face bones, by a preset's table if one is
    given; raises InvalidInput."""
    writable.check(no_face(scene, armature))
    options, own = native.bone_channels().nearest_surface(), surface(scene, armature)
    return own_controls.play_surface(performance, armature, own, preset, options)


def bake(
    scene,
    performance,
    take: str,
    armature,
    played,
    footage=None,
    use_head_motion: bool = True,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> own_controls.BakeSummary:
    """Keys a `mimetic.retarget.PlayedControls` on a rig's face bones, and the head's motion on
    those of head and neck, in one new action. What else its action holds goes on in a copy.
    tolerance, by_phases: of few keys, as `MotionKeys` has them. Raises InvalidInput, and changes
    nothing then, where a bone was renamed or removed meanwhile."""
    writable.check(writable.no_motion(armature))
    _check_channels(armature, played.names)
    keys = MotionKeys(tolerance, by_phases)
    target = head_target(armature)
    num_curves, text = 0, played.summary()
    if use_head_motion and target is not None:
        num_curves = head.bake(scene, performance, take, target, footage, keys).num_curves
    else:
        actions.continued_take(armature, f"{take} controls")
        text += f"; {rigs.head_bones(armature).remark}" if use_head_motion else ""
    num_curves += key(scene, performance, armature, played, footage, keys)
    text = "; ".join(filter(None, (keys.text(), text)))
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    return own_controls.BakeSummary(float(frames[0]), float(frames[-1]), num_curves, text)


def head_target(armature: bpy.types.Object) -> head.Target | None:
    """The bones that turn with the actor's head; None where none is known."""
    bones = rigs.head_bones(armature)
    if not bones.head:
        return None
    return head.Target(armature.name, bones.head, bones.neck, NECK_SHARE, translation_scale=0.0)


def _check_channels(armature: bpy.types.Object, names: Iterable[str]) -> None:
    known = {channel.name for channel in channels(armature)}
    if missing := [name for name in names if name not in known]:
        raise native.invalid_input(
            rpt_(
                "{name} has no bone to move for {control} any more: fit its controls again"
            ).format(name=armature.name, control=missing[0])
        )


def key(
    scene,
    performance,
    armature: bpy.types.Object,
    played,
    footage=None,
    keys: MotionKeys | None = None,
) -> int:
    """Keys the played channels in the armature's own action; returns the number of curves.

    A channel at rest is keyed only where a curve would go on instead, of a take before or by hand;
    one that is not played keeps a curve by hand, and loses that of a bake before.
    """
    keys = keys or MotionKeys()
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    holder = compat.curves(armature)
    values = dict(zip(played.names, played.values.T, strict=True))
    keyed: list[tuple[str, int]] = []
    for group in _together(c for c in channels(armature) if c.name in values):
        bone = armature.pose.bones[group[0].bone]
        is_resting = all(channel.name in played.resting for channel in group)
        if is_resting and not _curves_of(holder, bone, group[0]):
            continue
        rows = np.stack([values[channel.name] for channel in group], axis=-1)
        keyed += _key_channels(holder, armature, group, frames, rows, keys)
    baked_curves.replace(armature, set(keyed))
    return len(keyed)


def _curves_of(holder, bone: bpy.types.PoseBone, channel) -> list[bpy.types.FCurve]:
    """What moves a channel now."""
    if channel.is_turn:
        paths = {bone.path_from_id(path) for path in actions.ROTATION_PATHS}
        return [curve for curve in holder.fcurves if curve.data_path in paths]
    path = bone.path_from_id("location")
    return [c for c in holder.fcurves if c.data_path == path and c.array_index == channel.axis]


def _together(own: Iterable) -> list[list]:
    """Channels that are keyed at once: turns of one bone are one rotation."""
    groups: dict[tuple, list] = {}
    for channel in own:
        axis = None if channel.is_turn else channel.axis
        groups.setdefault((channel.bone, axis), []).append(channel)
    return list(groups.values())


def _key_channels(
    holder, armature: bpy.types.Object, group: list, frames, rows, keys: MotionKeys
) -> list[tuple[str, int]]:
    """Keys channels that belong together (rows: N x C) instead of what moved them; returns the path
    and index of each curve."""
    first = group[0]
    bone = armature.pose.bones[first.bone]
    for curve in _curves_of(holder, bone, first):
        holder.fcurves.remove(curve)
    if first.is_turn:
        axes = [channel.axis for channel in group]
        part, turns = native.bone_channels().turns(rows, bone.rotation_mode, axes)
        path = bone.path_from_id(part)
        count = keys.turn(holder, path, first.bone, frames, turns)
        return [(path, index) for index in range(count)]
    path = bone.path_from_id("location")
    curve = compat.new_curve(holder, path, first.axis, first.bone)
    keys.along(curve, frames, rows[:, 0], _unit(armature))
    return [(path, first.axis)]


def pose(armature: bpy.types.Object, own: list, values: dict[str, float]) -> None:
    """Puts bones as values of their channels say, as `key` would key them."""
    unit = _unit(armature)  # once: it evaluates what the bone before has changed
    for group in _together(own):
        bone = armature.pose.bones.get(group[0].bone)
        if bone is None:
            continue
        row = np.array([[values[channel.name] for channel in group]])
        if group[0].is_turn:
            axes = [channel.axis for channel in group]
            path, rows = native.bone_channels().turns(row, bone.rotation_mode, axes)
            setattr(bone, path, rows[0])
        else:
            bone.location[group[0].axis] = row[0, 0] * unit


def _unit(armature: bpy.types.Object) -> float:
    """A bone's location at value 1, in the armature's own unit."""
    metre = bpy.context.scene.unit_settings.scale_length or 1.0
    return native.bone_channels().CENTIMETRE / (metre * world.matrix(armature).median_scale)


def _responses(armature, face, own: list) -> np.ndarray:
    """K x V x 3: what the mesh does, in its own frame at rest, at value 1 of each channel."""
    responses = np.zeros((len(own), len(face.data.vertices), 3))
    with rest_pose.held(armature, face):
        to_rest = _to_rest(face)
        for response, channel in zip(responses, own, strict=True):
            ends = [_moved(armature, face, channel, side * STEP) for side in (1, -1)]
            response[:] = (ends[0] - ends[1]) / (2 * STEP)
    return to_rest.turn(responses)


def _reaches(armature, face, own: list, responses: np.ndarray) -> np.ndarray:
    """K x 2: how far each channel may go for its response to be what the mesh does, within its
    range: chains of bones fold where one is taken far."""
    reaches = np.array([channel.range for channel in own]).reshape(-1, 2)
    with rest_pose.held(armature, face):
        to_rest, before = _to_rest(face), rest_pose.evaluated(face)
        for reach, channel, response in zip(reaches, own, responses, strict=True):
            for side, end in enumerate(reach):
                moved = to_rest.turn(_moved(armature, face, channel, end) - before)
                reach[side] = native.bone_channels().reach(moved, response, end, STEP)
    return reaches


def _gaze(scene, armature, face, own: list, eyeballs) -> tuple:
    """As `eye_bones.measured`."""
    with rest_pose.held(armature, face):
        to_rest = _to_rest(face)
        gaze, carried = eye_bones.measured(
            scene, face, eyeballs, own, lambda *place: _with_value(armature, *place)
        )
    return gaze.turned(to_rest.rotation), to_rest.turn(carried)


def _to_rest(face):
    """Constraints to what is outside of the rig may hold the head turned though it is at rest."""
    return native.bone_channels().to_rest(rest_pose.evaluated(face), own_keys.rest_points(face))


def _moved(armature, face, channel, value: float) -> np.ndarray:
    with _with_value(armature, channel, value):
        return rest_pose.evaluated(face)


@contextmanager
def _with_value(armature, channel, value: float) -> Iterator[None]:
    """A channel at a value more than now."""
    bone = armature.pose.bones[channel.bone]
    before = bone.matrix_basis.copy()
    try:
        if channel.is_turn:
            axis = [float(axis == channel.axis) for axis in range(3)]
            turn = Quaternion(axis, value * native.bone_channels().TURN)
            bone.matrix_basis = before @ turn.to_matrix().to_4x4()
        else:
            bone.location[channel.axis] += value * _unit(armature)
        yield
    finally:
        bone.matrix_basis = before
