# SPDX-License-Identifier: GPL-3.0-or-later
"""What a strip of the NLA plays by itself, as Blender computes it: of its action which frame, by
which influence. Modifiers of the strip itself are not played."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
import numpy as np


def of(
    strip: bpy.types.NlaStrip, curves: Sequence[bpy.types.FCurve], frames: Sequence[int]
) -> np.ndarray:
    """N x C: what the strip makes of its action's curves at scene frames, over 0; 0 beside it."""
    rows = np.zeros((len(frames), len(curves)))
    for row, frame in zip(rows, map(float, frames), strict=True):
        if strip.frame_start <= frame <= strip.frame_end:
            at = _action_frame(strip, frame)
            row[:] = [curve.evaluate(at) for curve in curves]
            row *= _influence(strip, frame)
    return rows


def _action_frame(strip: bpy.types.NlaStrip, frame: float) -> float:
    first, last = strip.action_frame_start, strip.action_frame_end
    length = (last - first) or 1.0
    if strip.use_animated_time:
        at = _animated(strip, "strip_time", frame)
        return math.fmod(at - first, length) if strip.use_animated_time_cyclic else at
    # In single precision, as in Blender: at the ends of repeats else the other end is played
    repeated = np.float32(length) * np.float32(abs(strip.scale) or 1.0)
    offset = np.fmod(np.float32(frame) - np.float32(strip.frame_start), repeated)
    if frame == strip.frame_end and strip.repeat == math.floor(strip.repeat):
        offset = repeated
    share = float(offset / repeated)
    return last - share * length if strip.use_reverse else first + share * length


def _influence(strip: bpy.types.NlaStrip, frame: float) -> float:
    if strip.use_animated_influence:
        return min(max(_animated(strip, "influence", frame), 0.0), 1.0)
    since, until = frame - strip.frame_start, strip.frame_end - frame
    if strip.blend_in and since <= strip.blend_in:
        return since / strip.blend_in
    if strip.blend_out and until <= strip.blend_out:
        return until / strip.blend_out
    return 1.0


def _animated(strip: bpy.types.NlaStrip, name: str, frame: float) -> float:
    """A property of the strip's that has a curve of its own."""
    curve = strip.fcurves.find(name)
    is_keyed = curve is not None and not curve.is_empty
    return curve.evaluate(frame) if is_keyed else getattr(strip, name)
