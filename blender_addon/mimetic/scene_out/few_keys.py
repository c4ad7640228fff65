# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces the curves of a face by few keys with handles."""

from __future__ import annotations

from dataclasses import dataclass

from .. import compat, native
from . import actions


@dataclass(frozen=True)
class Reduction:
    keys_before: int
    keys_after: int
    error: float  # the farthest that a curve has moved at one of its keys


def curves_of(face) -> list:
    """The curves of the face's shape keys."""
    keys = face.data.shape_keys
    if keys is None or keys.animation_data is None or keys.animation_data.action is None:
        return []
    return list(compat.curves(keys).fcurves)


def reduce(face, tolerance: float, by_phases: bool = False) -> Reduction:
    """Replaces the keys of every curve of the face's shapes that has one a frame.

    by_phases: keys lie at onset, apex, release and end of each event first.
    """
    before = after = 0
    error = 0.0
    for curve in curves_of(face):
        if any(point.interpolation != "LINEAR" for point in curve.keyframe_points):
            continue  # few already, or someone's own
        frames, values = actions.dense_values(curve)
        before += len(frames)
        keys = native.sparse_curves().sparse_keys(frames, values, tolerance, by_phases)
        if len(keys.points) < len(frames):
            actions.fill_sparse(curve, keys)
            error = max(error, keys.error)
        after += min(len(keys.points), len(frames))
    return Reduction(before, after, error)
