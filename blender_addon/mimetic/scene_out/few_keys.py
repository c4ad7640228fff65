# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces the curves of a face by few keys with handles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import native
from . import actions, key_table
from .face_curves import Chosen
from .key_table import KeyTable


@dataclass(frozen=True)
class Reduction:
    keys_before: int
    keys_after: int
    error: float  # farthest that a curve moved at its keys or a whole frame, of a full activation


def reduce(chosen: Sequence[Chosen], tolerance: float, by_phases: bool = False) -> Reduction:
    """Replaces chosen keys that lie side by side by few, where they are one a frame.

    by_phases: keys lie at onset, apex, release and end of each event first.
    """
    native.sparse_curves().check_tolerance(tolerance)
    before = after = 0
    error = 0.0
    for one in chosen:
        table = key_table.read(one.of.curve)
        is_dense = one.is_chosen & _is_dense(table)
        parts = []
        for run in _runs(one.is_chosen):
            part = table.rows(run)
            # Elsewhere keys are few already, or someone's own
            if one.is_chosen[run][0] and is_dense[run].all():
                part, moved = _reduced(part, one.of.unit, tolerance, by_phases)
                error = max(error, moved)
            parts.append(part)
        few = key_table.joined(parts)
        before += int(is_dense.sum())
        after += len(few.keys.points) - int((~is_dense).sum())
        if len(few.keys.points) < len(table.keys.points):
            key_table.write(one.of.curve, few)
    return Reduction(before, after, error)


def _is_dense(table: KeyTable) -> np.ndarray:
    """Keys from which it goes straight to the next; the last, which has none, as that before it."""
    flags = table.columns["interpolation"] == actions.LINEAR
    flags[-1] = len(flags) > 1 and flags[-2]
    return flags


def _runs(is_chosen: np.ndarray) -> list[slice]:
    """Neighbours that are all chosen, or all not."""
    ends = np.flatnonzero(np.diff(is_chosen.astype(np.int8))) + 1
    bounds = [0, *(int(end) for end in ends), len(is_chosen)]
    return [slice(*pair) for pair in pairwise(bounds)]


def _reduced(
    table: KeyTable, unit: float, tolerance: float, by_phases: bool
) -> tuple[KeyTable, float]:
    frames, values = table.keys.points.T
    keys = native.sparse_curves().sparse_keys(frames, values / unit, tolerance, by_phases)
    if len(keys.points) >= len(frames):
        return table, 0.0
    few = key_table.as_cubics(table, keys.affine(unit, 0.0), actions.ALIGNED, actions.BEZIER)
    few.columns["interpolation"][-1] = table.columns["interpolation"][-1]  # to what comes after
    return few, keys.error
