# SPDX-License-Identifier: GPL-3.0-or-later
"""A few numbers by which changed points are recognised, despite rounding to single precision.

A hash would do for points that are only copied, but shapes that follow a sculpted neutral are
rounded again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

SIZE = 8
PERIOD = 8191  # of the signs: points are folded to so many numbers first
SIGNS = np.random.default_rng(36).choice([-1.0, 1.0], size=(PERIOD, SIZE))
# Of the largest coordinate: ten times what rounding adds, and less than a single point of 5,000
# adds that went a five-thousandth of it
TOLERANCE = 1e-6


def fingerprint(points: ArrayLike) -> NDArray[np.float64]:
    """SIZE sums of all coordinates (V x 3) with random signs, over the root of their number."""
    flat = np.asarray(points, dtype=np.float64).ravel()
    values = np.zeros(-(-max(flat.size, 1) // PERIOD) * PERIOD)
    values[: flat.size] = flat
    return values.reshape(-1, PERIOD).sum(axis=0) @ SIGNS / np.sqrt(max(flat.size, 1))


def is_same(one: ArrayLike, other: ArrayLike, largest: float) -> bool:
    """Whether two fingerprints are of the same points; largest: coordinate of the mesh."""
    apart = np.abs(np.subtract(one, other)).max()
    return bool(apart <= TOLERANCE * largest)
