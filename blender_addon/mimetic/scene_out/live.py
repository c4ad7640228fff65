# SPDX-License-Identifier: GPL-3.0-or-later
"""A live face in the scene: shown as it comes, and recorded into new actions."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import native, scene_in, world, writable
from . import actions, bound, by_hand, contact, own_keys, standing

HEAD_PATHS = {"head_position": "location", "head_rotation": "rotation"}
PLACE_PATHS = ("location", *actions.ROTATION_PATHS)


@dataclass(frozen=True)
class Place:
    """Where a take lies in the scene, as a movie clip says it."""

    frame_start: float
    frame_offset: int


@dataclass(frozen=True)
class TakeSummary:
    first: float  # scene frames of the first and the last key
    last: float
    num_curves: int
    remarks: tuple[str, ...]  # what is not played, in sentences


class LiveHead:
    """The object that a live head moves, from where it stands; its name may outlive an undo."""

    def __init__(self, scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
        self._place_before = {path: tuple(getattr(obj, path)) for path in PLACE_PATHS}
        self._stood = standing.of(obj)
        mover = bound.moved_by(obj)
        self.remark = (
            rpt_("{obj} is moved by {mover}: its head stays").format(obj=obj.name, mover=mover)
            if mover
            else ""
        )
        self._stand = None if mover else stand_of(scene, obj)
        self.rest = None  # head pose from which the head moves

    def show(self, obj: bpy.types.Object, pose) -> None:
        """pose: 4 x 4, camera from head."""
        if self._stand is None:
            return
        self.rest = pose if self.rest is None else self.rest
        channels = native.puppet("driven_face").head_channels(pose[None], self.rest, self._stand)
        setattr(obj, channels.rotation_path, channels.rotations[0])
        obj.location = channels.locations[0]

    def restore(self, obj: bpy.types.Object) -> None:
        if self._stand is not None:
            for path, place in self._place_before.items():
                setattr(obj, path, place)

    def record(self, obj, performance, take: str, frames, channels: frozenset[str]) -> int:
        """Keys those of the head's channels; returns the number of curves."""
        wanted = [channel for channel in HEAD_PATHS if channel in channels]
        if self._stand is None or not wanted:
            return 0
        rest = performance.head_pose[0] if self.rest is None else self.rest
        motion = native.puppet("driven_face").head_channels(
            performance.head_pose, rest, self._stand
        )
        holder = actions.continued_take(obj, f"{take} head")
        num_curves = 0
        if "head_rotation" in wanted:
            num_curves += actions.key_rotations(holder, "", "Head", frames, motion)
        if "head_position" in wanted:
            actions.clear(holder, "location")
            num_curves += actions.key_columns(holder, "location", "Head", frames, motion.locations)
        standing.note(obj, self._stood)
        return num_curves


class Puppet:
    """A face while a live session moves it, by name: an undo may replace the object."""

    def __init__(self, scene: bpy.types.Scene, face: bpy.types.Object) -> None:
        self.name = face.name
        keys = face.data.shape_keys
        driven = own_keys.driven_keys(keys)
        self._numbers = {
            shape: keys.key_blocks.find(key)
            for shape, key in by_hand.keys_now(face).items()
            if key not in driven
        }
        channel_of = native.puppet("driven_face").channel_of_slider
        self._channels = {shape: channel_of(shape) for shape in self._numbers}
        self._values = np.empty(len(keys.key_blocks), dtype=np.float32)
        keys.key_blocks.foreach_get("value", self._values)
        self._values_before = self._values.copy()
        self.head = LiveHead(scene, face)
        # Contact costs more than a picture's time; afterwards it is looked at again
        contact.still_faces.add(self.name)
        self._rest_contact(face)

    @property
    def sliders(self) -> set[str]:
        return set(self._numbers)

    def set_neutral(self) -> None:
        """The head moves from its next pose on."""
        self.head.rest = None

    def show(self, names, state, live_face) -> None:
        """Puts the face as a live state has it; live_face: the `LiveFace` that it is of."""
        face = bpy.data.objects.get(self.name)
        if face is None:
            return
        parts = native.puppet("driven_face")
        values = parts.slider_values(names, state.values, live_face.lids, self._numbers)
        for shape, value in values.items():
            # What is frozen stays as it was before the session, or as it was shown last
            if self._channels[shape] not in state.frozen:
                self._values[self._numbers[shape]] = value
        write_values(face, self._values)
        self.head.show(face, state.head_pose)

    def end(self) -> None:
        """Whoever moves the face from now on, its lips and lids are kept apart again."""
        contact.still_faces.discard(self.name)
        if face := bpy.data.objects.get(self.name):
            self._rest_contact(face)

    def _rest_contact(self, face) -> None:
        if contact.key_of(face) is not None:
            contact.rest(face)

    def restore(self) -> None:
        """Puts the face as it was before."""
        face = bpy.data.objects.get(self.name)
        if face is None:
            return
        write_values(face, self._values_before)
        self.head.restore(face)

    def record(
        self, scene: bpy.types.Scene, performance, take: str, place: Place, channels: frozenset[str]
    ) -> TakeSummary:
        """Keys a take; see `record`."""
        return record(scene, self, performance, take, place, channels)


def write_values(face: bpy.types.Object, values) -> None:
    """Sets all shape keys at once, unless some came or went since `values` were read."""
    keys = face.data.shape_keys
    if keys is not None and len(keys.key_blocks) == len(values):
        keys.key_blocks.foreach_set("value", values)
        keys.update_tag()


def stand_of(scene: bpy.types.Scene, face: bpy.types.Object):
    """Where a face's object stands: `mimetic.puppet.driven_face.Stand`."""
    with standing.at_rest(face):
        return native.puppet("driven_face").Stand(
            native.array(world.matrix(face)) @ bound.object_from_character(scene, face),
            native.array(face.location),
            native.array(world.own_rotation(face)),
            face.rotation_mode,
            bound.units_of(scene, face),
        )


def record(
    scene: bpy.types.Scene,
    puppet: Puppet,
    performance,
    take: str,
    place: Place,
    channels: frozenset[str],
) -> TakeSummary:
    """Keys a take on the face at its place in the scene, in new actions.

    channels: that are recorded (`mimetic.puppet.channels`); the curves of all else are copied from
    the actions that were there. The scene's rate and range stay.
    """
    face = writable.own_object(scene, puppet.name)
    if face.data.shape_keys is None:
        raise native.invalid_input(
            rpt_("{face} has lost its shape keys meanwhile").format(face=face.name)
        )
    parts = native.puppet("driven_face")
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, place))
    keys = face.data.shape_keys
    names, driven = by_hand.keys_now(face), own_keys.driven_keys(keys)
    shapes = native.shapes().slider_shapes_of(performance, puppet.sliders)
    shapes = [s for s in shapes if parts.channel_of_slider(s.name) in channels]
    playable = [s for s in shapes if s.name in names and names[s.name] not in driven]
    remarks = [puppet.head.remark] if puppet.head.remark else []
    if left_out := sorted({s.name for s in shapes} - {s.name for s in playable}):
        remarks.append(
            rpt_("{face} has no slider of its own for {names}").format(
                face=face.name, names=", ".join(left_out)
            )
        )
    num_curves = 0
    if playable:
        holder = actions.continued_take(keys, f"{take} muscles")
        for shape in playable:
            key = keys.key_blocks[names[shape.name]]
            actions.key_slider(holder, key, shape.group, frames, shape.values)
        num_curves = len(playable)
    num_curves += puppet.head.record(face, performance, take, frames, channels)
    return TakeSummary(float(frames[0]), float(frames[-1]), num_curves, tuple(remarks))
