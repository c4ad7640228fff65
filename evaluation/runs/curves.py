# SPDX-License-Identifier: GPL-3.0-or-later
"""When a curve rises and peaks, and how far an estimate of it is off, in frames."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from mimetic.score import scores
from numpy.typing import NDArray

ONSET_SHARE, PEAK_SHARE = 0.2, 0.9
LEAST_PEAK = 0.05


def onset_and_peak(curve: NDArray[np.float64]) -> tuple[float, float]:
    """Frames, counted from 0, between which they may lie; nan for a curve that does not rise.

    Onset: where it last passes a fifth of its peak on the way there. Peak: the middle of the time
    above nine tenths of it, as a held expression has no single highest frame.
    """
    top = int(curve.argmax())
    height = curve[top] - curve[0]
    if height < LEAST_PEAK:
        return math.nan, math.nan
    relative = (curve - curve[0]) / height
    return (
        _crossing(relative, ONSET_SHARE, top, -1),
        (_crossing(relative, PEAK_SHARE, top, -1) + _crossing(relative, PEAK_SHARE, top, 1)) / 2,
    )


def _crossing(curve: NDArray, level: float, start: int, step: int) -> float:
    """Where the curve falls under the level, walking from `start`; the end if it does not."""
    i = start
    while 0 <= i + step < len(curve):
        if curve[i + step] < level:
            share = (curve[i] - level) / (curve[i] - curve[i + step])
            return i + step * share
        i += step
    return float(i)


def timing_errors(
    curves: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]], rows: slice
) -> dict[str, list[float]]:
    """Frames by which onsets, peaks and delays between groups are off; nan where one is missing.

    rows: the frames of one expression. Groups that truth leaves silent there do not count.
    """
    errors: dict[str, list[float]] = {"onset": [], "peak": [], "delay": []}
    off = []
    for true, estimate in curves.values():
        if np.ptp(true[rows]) < scores.ACTIVE:
            continue
        true_times, estimated_times = onset_and_peak(true[rows]), onset_and_peak(estimate[rows])
        off.append(estimated_times[0] - true_times[0])
        errors["onset"].append(abs(estimated_times[0] - true_times[0]))
        errors["peak"].append(abs(estimated_times[1] - true_times[1]))
    errors["delay"] = [abs(a - b) for a, b in combinations(off, 2)]
    return errors


def correlations(
    curves: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]], rows: slice
) -> list[float]:
    """Pearson's over the frames of one expression, for each group that truth moves there."""
    return [
        scores.correlation(true[rows], estimate[rows])
        for true, estimate in curves.values()
        if np.ptp(true[rows]) > scores.ACTIVE
    ]
