# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on an object, an empty or an armature's bone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix

from .. import native, scene_in, world, writable
from . import actions, rigs, standing
from .motion_keys import MotionKeys


@dataclass(frozen=True)
class Target:
    """Where the motion goes, and how. Names, so that it may outlive an undo."""

    name: str  # of the object
    bone: str = ""
    neck: str = ""
    neck_share: float = 0.0
    is_absolute: bool = False
    rest_frame: int = 0  # of the footage; 0: where the head is best seen at rest
    facing: str = "-Y"
    translation_scale: float = 1.0  # 0 leaves locations alone
    pivot: tuple[float, float, float] = (0.0, 0.0, 0.0)  # metres


@dataclass(frozen=True)
class BakeSummary:
    first: float  # scene frames of the first and the last key
    last: float
    num_curves: int
    where: str


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    target: Target,
    footage=None,
    keys: MotionKeys | None = None,
) -> BakeSummary:
    """Keys the motion of a `mimetic.performance.Performance`; smooth it before if it shall be.

    keys: how, and what became of it; a key a frame where None.

    What else moves the target goes on: its action is copied, and the copy gets the head's curves.
    The scene's rate and range stay as they are. Raises InvalidInput, and changes nothing then.
    """
    obj = writable.own_object(scene, target.name)
    writable.check(writable.no_motion(obj))
    if obj.type == "ARMATURE" and not target.bone:
        writable.check(rigs.no_whole_motion(obj))
    timing = scene_in.timing(scene, footage)
    frames = scene_in.scene_frames(performance, timing)
    if not target.bone:
        channels = _object_channels(scene, obj, performance, target)
        num_curves = key_object(obj, take, frames, channels, keys)
        if target.is_absolute:
            standing.forget(obj)
        return BakeSummary(float(frames[0]), float(frames[-1]), num_curves, obj.name)
    new_channels = bone_carrier(scene, obj, target)(_motion(performance, target))
    holder = actions.continued_take(obj, f"{take} head")
    metres = metres_of(scene, obj)
    num_curves = key_bones(holder, frames, new_channels, keys, metres)
    where = ", ".join(new_channels) + rpt_(" of {obj}").format(obj=obj.name)
    return BakeSummary(float(frames[0]), float(frames[-1]), num_curves, where)


def placed(performance, world_from_space: Matrix, world_from_camera):
    """`mimetic.rig_motion.Channels`, of quaternions, of the performer's own head before its camera;
    world_from_space: of what the curves are in, whose scale takes the head off along with it."""
    return native.rig_motion().placed_channels(
        performance,
        native.array(world_from_space),
        "QUATERNION",
        world_from_camera,
        scale=world_from_space.median_scale,
    )


def key_object(obj, take: str, frames, channels, keys: MotionKeys | None = None) -> int:
    """Keys an object's own `mimetic.rig_motion.Channels`; returns the number of curves."""
    stood = standing.of(obj)
    holder = actions.continued_take(obj, f"{take} head")
    metres = metres_of(bpy.context.scene, obj.parent)
    num_curves = _key(holder, "", "Head", frames, channels, keys, metres)
    standing.note(obj, stood)
    return num_curves


def metres_of(scene: bpy.types.Scene, frame: bpy.types.Object | None) -> float:
    """A unit of what lies in an object's frame, or in the world."""
    scale = world.matrix(frame).median_scale if frame is not None else 1.0
    return scale * (scene.unit_settings.scale_length or 1.0)


def key_bones(
    holder, frames, new_channels: dict, keys: MotionKeys | None = None, metres: float = 1.0
) -> int:
    """Keys channels of bones by their names, instead of what curves there are; returns how many.

    metres: a unit of their locations.
    """
    num_curves = 0
    for bone, channels in new_channels.items():
        prefix = f'pose.bones["{bpy.utils.escape_identifier(bone)}"].'
        num_curves += _key(holder, prefix, bone, frames, channels, keys, metres)
    return num_curves


def _motion(performance, target: Target):
    return native.rig_motion().motion(
        performance, target.is_absolute, target.rest_frame or None, target.pivot
    )


def bone_carrier(scene: bpy.types.Scene, armature, target: Target) -> Callable:
    """What gives channels of the target's bones, by name, for a `mimetic.rig_motion.Motion`.

    How the head follows its neck is measured here, once.
    """
    share, inherited_share = 0.0, 1.0
    neck = None
    if target.neck and target.neck_share > 0:
        share, neck = target.neck_share, rigs.as_bone(armature, target.neck)
        inherited_share = rigs.followed_share(armature, target.bone, target.neck)
    head = rigs.as_bone(armature, target.bone)
    scale = target.translation_scale / metres_of(scene, armature)

    def carry(motion) -> dict:
        of_head, of_neck = native.rig_motion().bone_channels(
            motion, head, neck, share, inherited_share, target.facing, scale
        )
        channels = {target.bone: of_head if scale else _without_location(of_head)}
        return channels | ({target.neck: of_neck} if of_neck else {})

    return carry


def _object_channels(scene, obj, performance, target: Target):
    parts = native.rig_motion()
    if target.is_absolute:
        channels = parts.placed_channels(
            performance,
            native.array(world.space(obj)),
            obj.rotation_mode,
            scene_in.camera_matrix(scene),
            target.facing,
            target.translation_scale,
        )
    else:
        with standing.at_rest(obj):
            axes = parts.axes_of(native.array(world.matrix(obj)), target.facing)
            channels = parts.carried_channels(
                _motion(performance, target),
                native.array(obj.location),
                native.array(world.own_rotation(obj)),
                native.array(world.space(obj)),
                axes,
                obj.rotation_mode,
                target.translation_scale / metres_of(scene, None),
            )
    return channels if target.translation_scale else _without_location(channels)


def _without_location(channels):
    return type(channels)(channels.rotation_path, channels.rotations, None)


def _key(
    holder, prefix: str, group: str, frames, channels, keys: MotionKeys | None, metres: float
) -> int:
    """Replaces what curves there are."""
    keys = keys or MotionKeys()
    actions.clear_rotations(holder, prefix)
    path = prefix + channels.rotation_path
    num_curves = keys.turn(holder, path, group, frames, channels.rotations)
    if channels.locations is not None:
        path = prefix + "location"
        actions.clear(holder, path)
        num_curves += keys.shift(holder, path, group, frames, channels.locations, metres)
    return num_curves
