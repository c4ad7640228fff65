# SPDX-License-Identifier: GPL-3.0-or-later
"""How probable what was seen is under a person's skin: the evidence, and its maximum.

A frame's measured displacements d = H v + n are linear in the values v of muscles and articulators.
With their prior N(0, P) integrated out, d ~ N(0, I + H P H^T), d and H whitened by the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
STEP = 1e-2  # of the logarithms, for differences
LARGEST_STEP = 0.4  # of a logarithm in one round: modes are linearised between rounds
MOST_STEPS = 8
SETTLED = 1e-3


@dataclass(frozen=True)
class LinearFrame:
    """One frame's normal equations in the columns [modes, their changes by parameter 1, 2, ...].

    gram: C x C, pull: C, of whitened columns and displacements; C = A F for F free values and A - 1
    parameters. free: indices of the free values among all; std: F, their priors.
    """

    gram: Floats
    pull: Floats
    free: NDArray[np.int64]
    std: Floats

    def log_evidence(self, shares: Floats, log_strength: Floats) -> float:
        """Of the modes sum_a shares[a, j] columns[a, j], with strengths; both of all values.

        Without the part that does not depend on them: -|d|^2 / 2 and constants.
        """
        num_free = len(self.free)
        own = shares[:, self.free] * (self.std * np.exp(log_strength[self.free]))
        flat = own.ravel()
        weighed = (self.gram * flat).reshape(-1, len(own), num_free).sum(axis=1)
        normal = (weighed * flat[:, None]).reshape(len(own), num_free, num_free).sum(axis=0)
        pull = (self.pull * flat).reshape(len(own), num_free).sum(axis=0)
        root = np.linalg.cholesky(np.eye(num_free) + normal)
        half = np.linalg.solve(root, pull)
        return float(0.5 * half @ half - np.log(np.diagonal(root)).sum())


def linear_frame(
    columns: Floats, displacement: Floats, free: NDArray[np.int64], std: Floats
) -> LinearFrame:
    """columns: whitened, 2K x A F, modes first; displacement: whitened, 2K."""
    return LinearFrame(columns.T @ columns, columns.T @ displacement, free, std)


@dataclass(frozen=True)
class Peak:
    """A maximum: place, standard deviations from the curvature there, height."""

    place: Floats
    std: Floats
    height: float


def maximise(function: Callable[[Floats], float], start: Floats, bound: float) -> Peak:
    """The maximum within `bound` of `start` in each coordinate, by damped Newton steps.

    Derivatives by differences: parameters are a handful and the function is cheap.
    """
    place, height = start.copy(), function(start)
    damping = 1e-3
    for _ in range(MOST_STEPS):
        gradient, curvature = _derivatives(function, place, height)
        moved = None
        while damping < 1e6 and moved is None:
            # Eigenvalues of the wrong sign turned over: a step must lead upwards.
            values, vectors = np.linalg.eigh(-curvature)
            size = np.maximum(np.abs(values), 1e-6) + damping
            step = vectors @ ((vectors.T @ gradient) / size)
            wanted = np.clip(place + step, start - bound, start + bound)
            found = function(wanted)
            if found > height:
                moved = np.abs(wanted - place).max()
                place, height, damping = wanted, found, damping / 4
            else:
                damping = 4 * damping + 1e-3
        if moved is None or moved < SETTLED:
            break
    _, curvature = _derivatives(function, place, height)
    values, vectors = np.linalg.eigh(-curvature)
    variance = (vectors**2 / np.maximum(values, 1e-6)).sum(axis=1)
    return Peak(place, np.sqrt(variance), height)


def _derivatives(
    function: Callable[[Floats], float], place: Floats, height: float
) -> tuple[Floats, Floats]:
    """Gradient and matrix of second derivatives, by central differences."""
    count = len(place)
    offsets = STEP * np.eye(count)
    above = np.array([function(place + offset) for offset in offsets])
    below = np.array([function(place - offset) for offset in offsets])
    curvature = np.diag((above - 2 * height + below) / STEP**2)
    for i in range(count):
        for j in range(i):
            both = function(place + offsets[i] + offsets[j])
            mixed = (both - above[i] - above[j] + height) / STEP**2
            curvature[i, j] = curvature[j, i] = mixed
    return (above - below) / (2 * STEP), curvature
