# SPDX-License-Identifier: GPL-3.0-or-later
"""A live face on the shape keys or bones that a character's maker gave it."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from .. import control_rows, native, scene_in, writable
from . import face_bones, own_controls, own_keys
from .live import HEAD_PATHS, LiveHead, Place, TakeSummary, write_values
from .live_bones import LiveHeadBones


def _values(obj: bpy.types.Object) -> np.ndarray:
    blocks = obj.data.shape_keys.key_blocks
    values = np.empty(len(blocks), dtype=np.float32)
    blocks.foreach_get("value", values)
    return values


class ControlPuppet:
    """A character while a live session moves its own controls, by name: an undo may replace it.

    They are fitted once, here. A head with muscles that nothing else moves is moved too, and the
    head of a rig; that of a character with known names alone is keyed when a take ends. Raises
    InvalidInput.
    """

    def __init__(self, scene: bpy.types.Scene, character: bpy.types.Object) -> None:
        self.name = character.name
        self._is_rig = character.type == "ARMATURE"
        if self._is_rig:
            self._surface = face_bones.surface(scene, character)
            self._options = native.bone_channels().nearest_surface()
        else:
            self._surface, self._options = own_keys.surface(character), None
        ranges = (face_bones if self._is_rig else own_keys).ranges(character)
        self._rows = native.controls().refitted(control_rows.rows_of(character), ranges)
        self._driven = native.puppet("driven_face").DrivenControls(
            self._surface, self._rows, self._options
        )
        self._head: LiveHead | LiveHeadBones | None = None
        if self._is_rig:
            own = face_bones.channels(character)
            self._channels = [channel for channel in own if channel.name in self._driven.names]
            bones = {channel.bone for channel in self._channels}
            if (target := face_bones.head_target(character)) is not None:
                self._head = LiveHeadBones(character, target)
                bones.update(self._head.names)
            self._before = {b: character.pose.bones[b].matrix_basis.copy() for b in bones}
        else:
            self._before = {obj.name: _values(obj) for obj, _ in own_keys.holders(character)}
            if scene_in.is_face(character):
                self._head = LiveHead(scene, character)

    def set_neutral(self) -> None:
        """The head moves from its next pose on."""
        if self._head is not None:
            self._head.rest = None

    def show(self, names, state, face) -> None:
        """Puts the character as a live state has it; face: the `LiveFace` that it is of."""
        character = bpy.data.objects.get(self.name)
        if character is None:
            return
        values = self._driven.values(names, state, face)
        if self._is_rig:
            face_bones.pose(character, self._channels, values)
        else:
            self._set_keys(values)
        if self._head is not None:
            self._head.show(character, state.head_pose)

    def _set_keys(self, values: dict[str, float]) -> None:
        for obj, before in self._members():
            blocks, numbers = obj.data.shape_keys.key_blocks, before.copy()
            for name, value in values.items():
                if (number := blocks.find(name)) >= 0:
                    numbers[number] = value
            write_values(obj, numbers)

    def _members(self) -> Iterator[tuple[bpy.types.Object, np.ndarray]]:
        """The head and its companions, and what their keys were before."""
        for name, before in self._before.items():
            obj = bpy.data.objects.get(name)
            if obj is not None and obj.data.shape_keys is not None:
                yield obj, before

    def end(self) -> None:
        """Nothing of the character was switched off."""

    def restore(self) -> None:
        """Puts the character as it was before."""
        character = bpy.data.objects.get(self.name)
        if character is None:
            return
        if self._is_rig:
            for bone, matrix in self._before.items():
                if bone in character.pose.bones:
                    character.pose.bones[bone].matrix_basis = matrix
            return
        for obj, before in self._members():
            write_values(obj, before)
        if isinstance(self._head, LiveHead):
            self._head.restore(character)

    def record(
        self, scene: bpy.types.Scene, performance, take: str, place: Place, channels: frozenset[str]
    ) -> TakeSummary:
        """Keys a take as a bake does; of channels, those of the head alone can be left out."""
        character = writable.own_object(scene, self.name)
        played = native.playing().play(performance, self._surface, self._rows, self._options)
        bake = face_bones.bake if self._is_rig else own_controls.bake
        moves_head = bool(channels & set(HEAD_PATHS))
        turns = self._head if moves_head and isinstance(self._head, LiveHeadBones) else None
        baked_head = moves_head and turns is None
        summary = bake(scene, performance, take, character, played, place, baked_head)
        num_curves = summary.num_curves
        if turns is not None:  # from the rest pose that was shown
            frames = scene_in.scene_frames(performance, scene_in.timing(scene, place))
            num_curves += turns.record(character, performance, frames)
        return TakeSummary(summary.first, summary.last, num_curves, (summary.text,))
