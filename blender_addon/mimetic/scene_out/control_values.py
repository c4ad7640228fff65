# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a character's own controls, put without keys and put back as they were."""

from __future__ import annotations

import bpy
from mathutils import Matrix

from . import face_bones


def now(character: bpy.types.Object) -> dict[str, list[float]]:
    """What `put_back` needs: values of the shape keys, or poses of the face's bones, by name."""
    if character.type == "ARMATURE":
        bones = {channel.bone for channel in face_bones.channels(character)}
        return {
            name: [value for row in character.pose.bones[name].matrix_basis for value in row]
            for name in sorted(bones)
        }
    return {key.name: [key.value] for key in character.data.shape_keys.key_blocks}


def put(character: bpy.types.Object, values: dict[str, float], channels: list) -> None:
    """values: of controls; channels: `face_bones.channels` of a rig, else empty."""
    if character.type == "ARMATURE":
        own = [channel for channel in channels if channel.name in values]
        face_bones.pose(character, own, values)
        return
    blocks = character.data.shape_keys.key_blocks
    for name, value in values.items():
        if (key := blocks.get(name)) is not None:
            key.value = value


def put_back(character: bpy.types.Object, before: dict[str, list[float]]) -> None:
    """What came or went since is left as it is."""
    if character.type == "ARMATURE":
        for name, numbers in before.items():
            if (bone := character.pose.bones.get(name)) is not None:
                rows = [numbers[4 * row : 4 * row + 4] for row in range(4)]
                bone.matrix_basis = Matrix(rows)
        return
    keys = character.data.shape_keys
    for name, (value,) in before.items():
        if keys is not None and (key := keys.key_blocks.get(name)) is not None:
            key.value = value
