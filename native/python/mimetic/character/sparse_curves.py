# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves by few keys with handles, to edit by hand, within a tolerance of the dense ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.curve_keys import CurveKeys, cubic_keys
from mimetic.character.shapes import shapes_of
from mimetic.performance.document import Performance

USUAL_TOLERANCE = 0.02  # of an activation
CURVE_STD = 0.05  # of an activation, about what captures say of theirs; phases are fitted with it
# The error of a rotation, radians, over that of the worst of its parts: at most so much
TURN_ERRORS = {"rotation_quaternion": 4.0, "rotation_euler": 3.0, "rotation_axis_angle": 8.0}
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-4, 0.5
SAME_FRAME = 1e-3  # of a frame: nearer than that a curve is at the same value


@dataclass(frozen=True)
class SparseKeys(CurveKeys):
    """Few keys that stand for a dense curve."""

    error: float  # farthest from the dense curve at its frames and at whole ones
    keys_of_event: list[int]  # by phases: how many each event has, from onset to end

    def scaled(self, unit: float) -> SparseKeys:
        """The same keys of a curve in other units, whose values are `unit` times as large."""
        keys = self.affine(unit, 0.0)
        error = self.error * abs(unit)
        return SparseKeys(keys.points, keys.left, keys.right, error, self.keys_of_event)


def sparse_keys(
    frames: NDArray[np.float64],
    values: NDArray[np.float64],
    tolerance: float = USUAL_TOLERANCE,
    by_phases: bool = False,
) -> SparseKeys:
    """Few keys within `tolerance` of a dense curve (N frames, rising; N values), at its frames and,
    as straight lines lie between them, at whole frames, which a scene at another rate shows.

    by_phases: keys first at onset, apex, release and end of each event, as its phases are fitted.
    Handles end a third of the way to the neighbouring key, so that the curve is a cubic in time.
    Raises InvalidInput.
    """
    check_tolerance(tolerance)
    frames, rows = _with_whole_frames(frames, np.asarray(values)[:, None])
    values = np.ascontiguousarray(rows[:, 0])
    if by_phases:
        stds = np.full(len(values), CURVE_STD)
        curve, keys_of_event = _core.reduce_by_phases(frames, values, stds, tolerance)
    else:
        curve, keys_of_event = _core.reduce_curve(frames, values, tolerance), []
    keys = cubic_keys(curve.frames, curve.values, curve.slopes, curve.slopes)
    error = float(curve.error)
    return SparseKeys(keys.points, keys.left, keys.right, error, list(keys_of_event))


def sparse_rotation(
    frames: NDArray[np.float64], rows: NDArray[np.float64], path: str, tolerance: float
) -> tuple[list[SparseKeys], float]:
    """Few keys of a rotation's curves (N x C), all at the same frames; how far it may be off.

    path: rotation_quaternion, rotation_euler or rotation_axis_angle, by which the curves are read;
    tolerance: radians, within which the rotation stays at all N frames. Raises InvalidInput.
    """
    factor = TURN_ERRORS[path]
    keys = sparse_together(frames, rows, tolerance / factor)
    return keys, factor * max(one.error for one in keys)


def sparse_together(
    frames: NDArray[np.float64], rows: NDArray[np.float64], tolerance: float
) -> list[SparseKeys]:
    """Few keys of curves (N x C) within `tolerance` of each, as `sparse_keys`, all at the same
    frames."""
    frames, rows = _with_whole_frames(frames, rows)
    curves = _core.reduce_together(frames, np.asfortranarray(rows), tolerance)
    keys = [cubic_keys(one.frames, one.values, one.slopes, one.slopes) for one in curves]
    return [
        SparseKeys(key.points, key.left, key.right, float(one.error), [])
        for key, one in zip(keys, curves, strict=True)
    ]


def _with_whole_frames(
    frames: NDArray[np.float64], rows: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frames (N, rising) with the whole ones among them, and what straight lines between rows
    (N x C) are there."""
    frames = np.ascontiguousarray(frames, dtype=np.float64)
    rows = np.asarray(rows, dtype=np.float64)
    if len(frames) < 2 or not np.isfinite(frames).all() or (np.diff(frames) <= 0).any():
        return frames, rows
    whole = np.arange(np.ceil(frames[0]), frames[-1])
    after = np.clip(np.searchsorted(frames, whole), 1, len(frames) - 1)
    gap = np.minimum(np.abs(whole - frames[after - 1]), np.abs(frames[after] - whole))
    at = np.union1d(frames, whole[gap > SAME_FRAME])
    return at, np.column_stack([np.interp(at, frames, column) for column in rows.T])


def check_tolerance(tolerance: float) -> None:
    """Raises InvalidInput for a tolerance outside LEAST_TOLERANCE to MOST_TOLERANCE."""
    if not LEAST_TOLERANCE <= tolerance <= MOST_TOLERANCE:
        raise InvalidInput(
            f"the tolerance of few keys is {tolerance:g}; it must lie between {LEAST_TOLERANCE:g} "
            f"and {MOST_TOLERANCE:g} of a full activation"
        )


@dataclass(frozen=True)
class KeyCount:
    """What few keys make of the curves that a performance is keyed with."""

    few: int
    dense: int
    error: float  # the largest
    keys_of_event: list[int]  # by phases


def count_keys(performance: Performance, tolerance: float, by_phases: bool = False) -> KeyCount:
    """Few keys of muscles, articulators and eyes within the tolerance; raises InvalidInput."""
    frames = performance.frame.astype(np.float64)
    shapes = shapes_of(performance.without_detail())
    columns = np.array([shape.values for shape in shapes])
    keys = [sparse_keys(frames, values, tolerance, by_phases) for values in columns]
    counts = [count for one in keys for count in one.keys_of_event]
    few = sum(len(one.points) for one in keys)
    return KeyCount(few, columns.size, max(one.error for one in keys), counts)
