# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of a head's parts with curves of their own, for files: those carry no drivers.

A driver that follows the head's key sees that key as the exporter has it for the while, cut at 0 or
left out, and the glTF exporter animates no mesh that has no action.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from .. import compat
from . import actions, key_table, part_keys

GROUP, ACTION = "Parts", "Parts (for export)"


@contextmanager
def with_curves(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """While it lasts, keys that follow a key of the head have a copy of its curve instead."""
    undo = []
    try:
        for obj in objects:
            keys = obj.data.shape_keys
            if followed := _followed(keys):
                undo.append((keys, followed, *_add(keys, followed)))
        yield
    finally:
        for keys, followed, paths, action in undo:
            _take_off(keys, followed, paths, action)


def _followed(keys: bpy.types.Key) -> list[tuple[bpy.types.FCurve, bpy.types.FCurve]]:
    """Drivers of ours, each with the curve of the key that it follows."""
    pairs = []
    for driver, source, path in part_keys.drivers_of(keys):
        holder = compat.curves(source)
        curve = holder.fcurves.find(path) if holder is not None else None
        if curve is not None and not driver.mute:
            pairs.append((driver, curve))
    return pairs


def _add(keys: bpy.types.Key, followed) -> tuple[list[str], bpy.types.Action | None]:
    """Returns the paths of the new curves, and the action that was made for them, if one was."""
    holder, action = compat.curves(keys), None
    if holder is None:
        action = compat.new_action(ACTION, keys)
        holder = compat.curves(keys)
    for driver, curve in followed:
        driver.mute = True
        own = compat.new_curve(holder, driver.data_path, 0, GROUP)
        key_table.write(own, key_table.read(curve))
        own.mute, own.extrapolation = curve.mute, curve.extrapolation
    return [driver.data_path for driver, _ in followed], action


def _take_off(keys: bpy.types.Key, followed, paths: list[str], action) -> None:
    for driver, _ in followed:
        driver.mute = False
    if action is not None:
        keys.animation_data.action = None
        bpy.data.actions.remove(action)
    else:
        for path in paths:
            actions.clear(compat.curves(keys), path)
    keys.update_tag()
