# SPDX-License-Identifier: GPL-3.0-or-later
"""The sliders of a face: the values of its shape keys, all at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import bpy
import numpy as np

from .contact import KEY, points_of


def values_of(face: bpy.types.Object) -> dict[str, float]:
    """The values of all shape keys but the basis; muted ones are 0."""
    keys = face.data.shape_keys
    return {
        key.name: 0.0 if key.mute else key.value
        for key in keys.key_blocks
        if key != keys.reference_key
    }


def levels_of(keys: bpy.types.Key) -> dict[str, float]:
    """The values of the shape keys that are not at 0, nor muted, but for the basis."""
    blocks = keys.key_blocks
    levels = np.empty(len(blocks), dtype=np.float32)
    is_muted = np.empty(len(blocks), dtype=bool)
    blocks.foreach_get("value", levels)
    blocks.foreach_get("mute", is_muted)
    levels[is_muted] = 0
    levels[0] = 0  # the basis
    return {blocks[int(i)].name: float(levels[i]) for i in np.flatnonzero(levels)}


def take_levels(keys: bpy.types.Key, evaluated_face: bpy.types.Key) -> None:
    """Gives the keys the values that their curves have where a picture is rendered.

    Keys that are changed there are copied anew, and their curves are not read again.
    """
    levels = np.empty(len(keys.key_blocks), dtype=np.float32)
    own = np.empty_like(levels)
    evaluated_face.key_blocks.foreach_get("value", levels)
    keys.key_blocks.foreach_get("value", own)
    if not np.array_equal(levels, own):
        keys.key_blocks.foreach_set("value", levels)


Weights = dict[str, np.ndarray | None]  # of vertices in vertex groups, by the group's name


def moves(
    face: bpy.types.Object,
    values: Mapping[str, float],
    rest: np.ndarray,
    weights: Weights | None = None,
) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
    """Value, points and points at 0 of every shape that is not at 0; rest: the basis' points.

    A key that a vertex group limits has points where it takes them. weights: of groups that were
    read before, as that takes long; those that are read here are added.
    """
    keys = face.data.shape_keys
    basis, weights = keys.reference_key, {} if weights is None else weights
    for name, value in values.items():
        key = keys.key_blocks[name]
        if value != 0.0 and key != basis:
            start = rest if key.relative_key == basis else points_of(key.relative_key)
            yield value, _limited(face, key, start, weights), start


def _limited(
    face: bpy.types.Object, key: bpy.types.ShapeKey, start: np.ndarray, weights: Weights
) -> np.ndarray:
    points, group = points_of(key), key.vertex_group
    if not group:
        return points
    if group not in weights:
        weights[group] = group_weights(face, group)
    share = weights[group]
    return points if share is None else start + share[:, None] * (points - start)


def group_weights(face: bpy.types.Object, name: str) -> np.ndarray | None:
    """V float32 of a vertex group; None if there is none, and a key of it moves all vertices."""
    group = face.vertex_groups.get(name)
    if group is None:
        return None
    weights, number = np.zeros(len(face.data.vertices), dtype=np.float32), group.index
    for vertex in face.data.vertices:
        for member in vertex.groups:
            if member.group == number:
                weights[vertex.index] = member.weight
    return weights


def set_values(face: bpy.types.Object, values: Mapping[str, float]) -> None:
    """Sets the named sliders and leaves the others; sliders end at their own limits.

    Faster than setting each by its property, which notifies Blender every time.
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
    names = set(face.data.shape_keys.key_blocks.keys()) - {KEY}
    set_values(face, dict.fromkeys(names, 0.0))
