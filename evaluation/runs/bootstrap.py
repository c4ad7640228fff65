# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a pooled figure depends on who was filmed."""

from __future__ import annotations

import math

import numpy as np

from evaluation.runs.deviation import Explained

INTERVAL = (0.05, 0.95)
NUM_DRAWS, SEED = 2000, 4


def r2_interval(by_person: dict[str, list[Explained]]) -> tuple[float, float]:
    """Between which R2 of all lies for nine in ten samples of as many people, drawn from these with
    replacement [Efron, Tibshirani: An introduction to the bootstrap, 1993]. Not defined for one."""
    if len(by_person) < 2:
        return math.nan, math.nan
    people = [Explained.all_of(parts) for parts in by_person.values()]
    error = np.array([person.error for person in people])
    motion = np.array([person.motion for person in people])
    draws = np.random.default_rng(SEED).integers(len(people), size=(NUM_DRAWS, len(people)))
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = 1 - error[draws].sum(axis=1) / motion[draws].sum(axis=1)
    shares = shares[np.isfinite(shares)]  # of people who move
    if not len(shares):
        return math.nan, math.nan
    low, high = np.quantile(shares, INTERVAL)
    return float(low), float(high)
