# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the bones of a rig's face, by what the mesh does when they move.

The mesh has muscles; how it follows each bone is measured by moving the bone a little and
evaluating the rig, constraints, drivers and all, with every bone at rest (`rest_pose`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Quaternion

from .. import compat, native, scene_in, world, writable
from . import actions, baked_curves, head, own_controls, own_keys, rest_pose, rigs
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
    """`mimetic.retarget.BoneChannel`s of the face's bones, but for those that drivers set."""
    package = native.bone_channels()
    driven = actions.driver_paths(armature)
    own = []
    for name in package.face_bones([bone.name for bone in armature.pose.bones]):
        bone = armature.pose.bones[name]
        can_move = not (bone.bone.use_connect and bone.bone.parent)
        prefix = bone.path_from_id()
        if any(path.startswith(prefix) for path in driven):
            continue
        own += package.channels_of(name, can_move, tuple(bone.lock_location), bone.lock_rotation[0])
    return own


def surface(scene: bpy.types.Scene, armature: bpy.types.Object):
    """A `mimetic.retarget.ControlSurface`: channels of bones by their measured responses."""
    face = deformed_face(scene, armature)
    own = channels(armature)
    return replace(
        own_keys.surface(face),
        control_names=[channel.name for channel in own],
        controls=_responses(armature, face, own),
        control_range=np.tile(native.bone_channels().RANGE, (len(own), 1)),
        # What bones take along within the head is as its weights chance to be
        heeds_hidden=False,
    )


def ranges(armature: bpy.types.Object) -> dict[str, list[float]]:
    """Least and greatest value of each channel of the face's bones, by name."""
    return {channel.name: list(native.bone_channels().RANGE) for channel in channels(armature)}


def play(
    scene: bpy.types.Scene, performance, armature: bpy.types.Object, preset: str | None = None
):
    """`mimetic.retarget.PlayedControls` of the rig's face bones, by a preset's table if one is
    given; raises InvalidInput."""
    writable.check(no_face(scene, armature))
    options, own = native.bone_channels().nearest_surface(), surface(scene, armature)
    rows = own_controls.preset_rows(own, preset)
    return native.playing().play(performance, own, rows, options)


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
    for channel in channels(armature):
        if channel.name not in values:
            continue
        is_resting = channel.name in played.resting
        if is_resting and not _curves_of(holder, armature.pose.bones[channel.bone], channel):
            continue
        keyed += _key_channel(holder, armature, channel, frames, values[channel.name], keys)
    baked_curves.replace(armature, set(keyed))
    return len(keyed)


def _curves_of(holder, bone: bpy.types.PoseBone, channel) -> list[bpy.types.FCurve]:
    """What moves a channel now."""
    if channel.is_turn:
        paths = {bone.path_from_id(path) for path in actions.ROTATION_PATHS}
        return [curve for curve in holder.fcurves if curve.data_path in paths]
    path = bone.path_from_id("location")
    return [c for c in holder.fcurves if c.data_path == path and c.array_index == channel.axis]


def _key_channel(
    holder, armature: bpy.types.Object, channel, frames, values, keys: MotionKeys
) -> list[tuple[str, int]]:
    """Keys one channel instead of what moved it; returns the path and index of each curve."""
    bone = armature.pose.bones[channel.bone]
    for curve in _curves_of(holder, bone, channel):
        holder.fcurves.remove(curve)
    if channel.is_turn:
        part, rows = native.bone_channels().turns(values, bone.rotation_mode)
        path = bone.path_from_id(part)
        count = keys.turn(holder, path, channel.bone, frames, rows)
        return [(path, index) for index in range(count)]
    path = bone.path_from_id("location")
    curve = compat.new_curve(holder, path, channel.axis, channel.bone)
    keys.along(curve, frames, values, _unit(armature))
    return [(path, channel.axis)]


def pose(armature: bpy.types.Object, own: list, values: dict[str, float]) -> None:
    """Puts bones as values of their channels say, as `key` would key them."""
    for channel in own:
        bone = armature.pose.bones.get(channel.bone)
        if bone is None:
            continue
        value = values[channel.name]
        if channel.is_turn:
            path, rows = native.bone_channels().turns(np.array([value]), bone.rotation_mode)
            setattr(bone, path, rows[0])
        else:
            bone.location[channel.axis] = value * _unit(armature)


def _unit(armature: bpy.types.Object) -> float:
    """A bone's location at value 1, in the armature's own unit."""
    metre = bpy.context.scene.unit_settings.scale_length or 1.0
    return native.bone_channels().CENTIMETRE / (metre * world.matrix(armature).median_scale)


def _responses(armature, face, own: list) -> np.ndarray:
    """K x V x 3: what the mesh does, in its own frame at rest, at value 1 of each channel."""
    responses = np.zeros((len(own), len(face.data.vertices), 3))
    with rest_pose.held(armature, face):
        before = rest_pose.evaluated(face)
        for response, channel in zip(responses, own, strict=True):
            ends = [_moved(armature, face, channel, side * STEP) for side in (1, -1)]
            response[:] = (ends[0] - ends[1]) / (2 * STEP)
    # Constraints to what is outside of the rig may hold the head turned all the same
    return native.bone_channels().at_rest(responses, before, own_keys.rest_points(face))


def _moved(armature, face, channel, value: float) -> np.ndarray:
    bone = armature.pose.bones[channel.bone]
    before = bone.matrix_basis.copy()
    try:
        if channel.is_turn:
            axis = [float(axis == channel.axis) for axis in range(3)]
            turn = Quaternion(axis, value * native.bone_channels().TURN)
            bone.matrix_basis = before @ turn.to_matrix().to_4x4()
        else:
            bone.location[channel.axis] += value * _unit(armature)
        return rest_pose.evaluated(face)
    finally:
        bone.matrix_basis = before
