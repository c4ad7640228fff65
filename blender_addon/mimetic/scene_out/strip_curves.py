# SPDX-License-Identifier: GPL-3.0-or-later
"""What strips of the NLA play as curves, for files: the glTF exporter writes actions alone, and
keys that go below 0 are split by their curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from .. import compat
from . import actions

GROUP, ACTION = "Strips", "Strips (for export)"

Curve = tuple[str, int]  # data path and index


@contextmanager
def with_curves(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """While it lasts, objects and shape keys that strips move have curves instead, a key a frame.

    Strips that are open in tweak mode stay as they are.
    """
    blocks = [block for obj in objects for block in (obj, _keys(obj)) if block and plays(block)]
    if not blocks:
        yield
        return
    sampled = _sample(scene, {block: _curves(block) for block in blocks})
    before = []
    try:
        for block, (frames, columns) in sampled.items():
            before.append(
                (block, block.animation_data.action, compat.slot_of(block.animation_data))
            )
            block.animation_data.use_nla = False
            compat.new_action(ACTION, block)
            holder = compat.curves(block)
            for (path, index), values in columns.items():
                curve = compat.new_curve(holder, path, index, GROUP)
                actions.fill(curve, frames, values, actions.LINEAR)
        yield
    finally:
        for block, action, slot in before:
            own = block.animation_data.action
            if action is not None:
                compat.assign(block, action, slot)
            else:
                block.animation_data.action = None
            block.animation_data.use_nla = True
            bpy.data.actions.remove(own)


def playing(block: bpy.types.ID) -> list[bpy.types.NlaStrip]:
    """Strips of actions that move a block, those that lie over others last."""
    animation = block.animation_data
    tracks = animation.nla_tracks if animation is not None and animation.use_nla else ()
    strips = [strip for track in tracks if not track.mute for strip in track.strips]
    return [strip for strip in strips if strip.action is not None and not strip.mute]


def _keys(obj: bpy.types.Object) -> bpy.types.Key | None:
    return getattr(obj.data, "shape_keys", None)


def plays(block: bpy.types.ID) -> bool:
    """Whether strips move a block; strips that are open in tweak mode count as none."""
    animation = block.animation_data
    return bool(
        animation is not None
        and animation.use_nla
        and not animation.use_tweak_mode
        and any(not track.mute and len(track.strips) for track in animation.nla_tracks)
    )


def _curves(block: bpy.types.ID) -> dict[Curve, tuple[float, float]]:
    """What strips and the action on top of them move, and from which frame to which."""
    animation = block.animation_data
    spans: dict[Curve, tuple[float, float]] = {}
    played = [
        (strip.action, compat.slot_of(strip), strip.frame_start, strip.frame_end)
        for strip in playing(block)
    ]
    if animation.action is not None:
        played.append((animation.action, compat.slot_of(animation), *animation.action.frame_range))
    for action, slot, first, last in played:
        for curve in compat.curves_of(action, slot):
            at = curve.data_path, curve.array_index
            low, high = spans.get(at, (first, last))
            spans[at] = min(low, first), max(high, last)
    return spans


def _sample(scene: bpy.types.Scene, blocks: dict[bpy.types.ID, dict]) -> dict:
    """Frames, and values of each curve in them, by block; the scene's frame stays."""
    spans = [span for curves in blocks.values() for span in curves.values()]
    if not spans:
        return {}
    first, last = (
        math.floor(min(low for low, _ in spans)),
        math.ceil(max(high for _, high in spans)),
    )
    frames, current = np.arange(first, last + 1), scene.frame_current_final
    rows = {block: {curve: np.empty(len(frames)) for curve in blocks[block]} for block in blocks}
    try:
        for i, frame in enumerate(frames):
            scene.frame_set(int(frame))
            for block, columns in rows.items():
                for (path, index), values in columns.items():
                    values[i] = _value(block, path, index)
    finally:
        scene.frame_set(math.floor(current), subframe=current % 1)
    return {
        block: (frames, {curve: v for curve, v in columns.items() if not np.isnan(v).any()})
        for block, columns in rows.items()
    }


def _value(block: bpy.types.ID, path: str, index: int) -> float:
    """Not a number where a curve moves nothing."""
    try:
        value = block.path_resolve(path)
    except ValueError:
        return math.nan
    return float(value) if isinstance(value, int | float) else float(value[index])
