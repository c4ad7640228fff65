# SPDX-License-Identifier: GPL-3.0-or-later
"""The sliders of a face: the values of its shape keys, all at once."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np


def values_of(face: bpy.types.Object) -> dict[str, float]:
    """The values of all shape keys but the basis; muted ones are 0."""
    keys = face.data.shape_keys
    return {
        key.name: 0.0 if key.mute else key.value
        for key in keys.key_blocks
        if key != keys.reference_key
    }


def set_values(face: bpy.types.Object, values: Mapping[str, float]) -> None:
    """Sets the named sliders and leaves the others; sliders end at their own limits.

    Faster than setting each by its property, which tells Blender of a change every time.
    """
    keys = face.data.shape_keys
    blocks = keys.key_blocks
    levels = np.empty(len(blocks), dtype=np.float32)
    blocks.foreach_get("value", levels)
    for i, key in enumerate(blocks):
        if key.name in values:
            levels[i] = min(max(values[key.name], key.slider_min), key.slider_max)
    blocks.foreach_set("value", levels)
    keys.update_tag()


def rest(face: bpy.types.Object) -> None:
    """All sliders at 0: the face at rest."""
    set_values(face, dict.fromkeys(face.data.shape_keys.key_blocks.keys(), 0.0))
