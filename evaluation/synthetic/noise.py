# SPDX-License-Identifier: GPL-3.0-or-later
"""Seeded value noise in three dimensions, the grain of every painted surface."""

from __future__ import annotations

import numpy as np

LATTICE = 32


class ValueNoise:
    """Smooth random field of space, mean 0, between -1 and 1, fixed by its seed."""

    def __init__(self, seed: int) -> None:
        self._lattice = np.random.default_rng(seed).uniform(-1, 1, (LATTICE,) * 3)

    def __call__(self, points: np.ndarray, period: float | tuple[float, ...]) -> np.ndarray:
        """Values (N,) at points (N,3); `period` is the distance between independent values."""
        where = points / np.asarray(period, float)
        cell = np.floor(where).astype(int)
        along = where - cell
        along = along * along * (3 - 2 * along)
        total = np.zeros(len(points))
        for corner in np.ndindex(2, 2, 2):
            at = (cell + corner) % LATTICE
            weight = np.where(np.array(corner, bool), along, 1 - along).prod(1)
            total += weight * self._lattice[at[:, 0], at[:, 1], at[:, 2]]
        return total

    def octaves(self, points: np.ndarray, periods: tuple[float, ...]) -> np.ndarray:
        """Sum of the fields of several periods, each shifted so that they do not line up."""
        shifted = [self(points + 0.37 * i, period) for i, period in enumerate(periods)]
        return np.sum(shifted, axis=0)


def smoothstep(low: float, high: float, x: np.ndarray) -> np.ndarray:
    """0 below `low`, 1 above `high`, smooth between; the limits may be given in falling order."""
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)
