# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys that go below 0 as two that do not, as a .glb has them: other programs cut at 0."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from .. import compat
from . import contact

SUFFIX = ".negative"  # as `mimetic.character.gltf.split_negative` has it


@contextmanager
def split(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """While it lasts, keys whose curves go below 0 stop there, and keys of their opposite
    displacement go on. Keys without a curve, and those that drivers set, stay as they are."""
    undo = []
    try:
        for obj in objects:
            for key, curve in _below_zero(obj):
                undo.append((obj, key.name, key.slider_min))
                _add(obj, key, curve)
        yield
    finally:
        for obj, name, lowest in undo:
            _take_off(obj, name, lowest)


def _below_zero(obj: bpy.types.Object) -> list[tuple[bpy.types.ShapeKey, bpy.types.FCurve]]:
    keys = obj.data.shape_keys
    holder = compat.curves(keys)
    if holder is None:
        return []
    pairs = ((key, holder.fcurves.find(key.path_from_id("value"))) for key in keys.key_blocks)
    return [(key, curve) for key, curve in pairs if curve is not None and _goes_below(key, curve)]


def _goes_below(key: bpy.types.ShapeKey, curve: bpy.types.FCurve) -> bool:
    first, last = curve.range()
    frames = np.arange(np.floor(first), np.ceil(last) + 1)
    return key.slider_min < 0 and min(map(curve.evaluate, frames)) < 0


def _add(obj: bpy.types.Object, key: bpy.types.ShapeKey, curve: bpy.types.FCurve) -> None:
    keys = obj.data.shape_keys
    rest, highest = contact.points_of(key.relative_key), -key.slider_min
    opposite = obj.shape_key_add(name=key.name + SUFFIX, from_mix=False)
    opposite.relative_key = key.relative_key
    opposite.slider_min, opposite.slider_max = 0.0, highest
    points = 2 * rest - contact.points_of(key)
    opposite.points.foreach_set("co", points.astype(np.float32).ravel())
    path = opposite.path_from_id("value")
    mirrored = compat.new_curve(compat.curves(keys), path, 0, "Negative")
    points = mirrored.keyframe_points
    points.add(len(curve.keyframe_points))
    for new, old in zip(points, curve.keyframe_points, strict=True):
        new.interpolation = old.interpolation
        for name in ("handle_left_type", "handle_right_type"):
            setattr(new, name, getattr(old, name))
        for name in ("co", "handle_left", "handle_right"):
            x, y = getattr(old, name)
            setattr(new, name, (x, -y))
    mirrored.update()
    key.slider_min = 0.0


def _take_off(obj: bpy.types.Object, name: str, lowest: float) -> None:
    keys = obj.data.shape_keys
    keys.key_blocks[name].slider_min = lowest
    if (opposite := keys.key_blocks.get(name + SUFFIX)) is None:
        return
    holder = compat.curves(keys)
    if curve := holder.fcurves.find(opposite.path_from_id("value")):
        holder.fcurves.remove(curve)
    obj.shape_key_remove(opposite)
