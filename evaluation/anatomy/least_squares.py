# SPDX-License-Identifier: GPL-3.0-or-later
"""Least squares with bounds on the unknowns."""

from __future__ import annotations

import numpy as np
from mimetic import _core
from numpy.typing import NDArray

MOST_SWEEPS = 20_000
SMALL_CHANGE = 1e-9  # of the unknowns' size, between checks


def bounded_fit(system, target, lowest, highest) -> NDArray[np.float64]:
    """K x T values between `lowest` and `highest` (K) that bring system @ values nearest to wanted.

    system: P x K; target: P x T, each column its own problem; bounds may be infinite. Accelerated
    projected gradients with restarts (Beck and Teboulle 2009; O'Donoghue and Candes 2015). Raises
    InvalidInput if shapes disagree or a lower bound lies above the upper one.
    """
    system, target = (np.asarray(a, dtype=np.float64) for a in (system, target))
    lowest, highest = (np.asarray(a, dtype=np.float64)[:, None] for a in (lowest, highest))
    if system.ndim != 2 or target.ndim != 2 or len(system) != len(target):
        raise _core.InvalidInput(f"system {system.shape} and wanted {target.shape} do not fit")
    if len(lowest) != system.shape[1] or len(highest) != len(lowest) or (lowest > highest).any():
        raise _core.InvalidInput("every unknown needs a lower bound below its upper one")
    scale = np.maximum(np.linalg.norm(system, axis=0), 1e-300)[:, None]
    gram = (system / scale.T).T @ (system / scale.T)
    right = (system / scale.T).T @ target
    step = 1 / np.linalg.eigvalsh(gram)[-1]
    values = np.clip(np.zeros_like(right), lowest * scale, highest * scale)
    ahead, inertia = values, np.ones(right.shape[1])
    for sweep in range(MOST_SWEEPS):
        before = values
        slope = gram @ ahead - right
        values = np.clip(ahead - step * slope, lowest * scale, highest * scale)
        restart = ((ahead - values) * (values - before)).sum(axis=0) > 0
        faster = (1 + np.sqrt(1 + 4 * inertia**2)) / 2
        share = np.where(restart, 0, (inertia - 1) / faster)
        inertia = np.where(restart, 1, faster)
        ahead = values + share * (values - before)
        if sweep % 50 == 49 and np.abs(values - before).max() < SMALL_CHANGE * np.abs(values).max():
            break
    return np.clip(values / scale, lowest, highest)
