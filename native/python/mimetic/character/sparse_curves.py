# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves by few keys with handles, to edit by hand, within a tolerance of the dense ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.document import Performance

USUAL_TOLERANCE = 0.02  # of an activation
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-4, 0.5


@dataclass(frozen=True)
class SparseKeys:
    """Keys of one curve: frame and value each, K x 2, of the key and of its two handles."""

    points: NDArray[np.float64]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    error: float  # farthest from the dense curve at its frames


def sparse_keys(
    frames: NDArray[np.float64], values: NDArray[np.float64], tolerance: float = USUAL_TOLERANCE
) -> SparseKeys:
    """Few keys within `tolerance` of a dense curve (N frames, rising; N values).

    Handles end a third of the way to the neighbouring key, so that the curve is a cubic in time.
    Raises InvalidInput.
    """
    check_tolerance(tolerance)
    curve = _core.reduce_curve(
        np.asarray(frames, dtype=np.float64), np.asarray(values, dtype=np.float64), tolerance
    )
    spans = np.diff(curve.frames) / 3
    before = np.concatenate([spans[:1], spans]) if len(spans) else np.ones(1)
    after = np.concatenate([spans, spans[-1:]]) if len(spans) else np.ones(1)
    points = np.column_stack([curve.frames, curve.values])
    left, right = (
        np.column_stack([curve.frames + reach, curve.values + reach * curve.slopes])
        for reach in (-before, after)
    )
    return SparseKeys(points, left, right, float(curve.error))


def check_tolerance(tolerance: float) -> None:
    """Raises InvalidInput for a tolerance outside LEAST_TOLERANCE to MOST_TOLERANCE."""
    if not LEAST_TOLERANCE <= tolerance <= MOST_TOLERANCE:
        raise InvalidInput(
            f"the tolerance of few keys is {tolerance:g}; it must lie between {LEAST_TOLERANCE:g} "
            f"and {MOST_TOLERANCE:g} of a full activation"
        )


def key_share(performance: Performance, tolerance: float) -> tuple[int, int, float]:
    """Keys of all muscles and articulators: few, dense, and the largest error of the few."""
    frames = performance.frame.astype(np.float64)
    columns = np.hstack([performance.activations, performance.articulator_values]).T
    keys = [sparse_keys(frames, values, tolerance) for values in columns]
    few = sum(len(one.points) for one in keys)
    return few, columns.size, max(one.error for one in keys)
