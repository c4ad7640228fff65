# SPDX-License-Identifier: GPL-3.0-or-later
"""A live recording beside an offline capture of the same frames: how alike, how late, how still."""

from __future__ import annotations

import numpy as np
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.head_turn import angles, head_turn
from numpy.typing import NDArray

from evaluation.runs.real_still import jitter

GROUPS = range(1, 8)
MOVES = 0.03  # standard deviation of a curve that does anything; below it a correlation is noise
JAW, LIDS, GAZE = "jaw", "lids", "gaze"
HEAD = ("yaw", "pitch", "roll")
LATEST, EARLIEST = 6, -3  # frames of lag that are tried
Curves = dict[str, NDArray[np.float64]]


def curves_of(performance: Performance, rows: NDArray[np.intp]) -> Curves:
    """Groups of muscles, jaw, lids, gaze and head: N each."""
    curves = {
        f"group {group}": performance.activations[rows][:, performance.groups == group].mean(axis=1)
        for group in GROUPS
    }
    names = list(performance.articulators)
    values = performance.articulator_values[rows]
    curves[JAW] = values[:, names.index("jaw_open")]
    curves[LIDS] = values[:, [names.index(f"lid_upper.{side}") for side in "LR"]].mean(axis=1)
    yaw = values[:, [names.index(f"gaze_yaw.{side}") for side in "LR"]].mean(axis=1)
    curves[GAZE] = yaw / 30
    turns = np.array([angles(head_turn(pose)) for pose in performance.head_pose[rows]])
    return curves | dict(zip(HEAD, turns.T, strict=True))


def common_rows(a: Performance, b: Performance) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Of the frames that both have and neither holds."""
    frames = np.intersect1d(a.frame[a.quality >= HELD_QUALITY], b.frame[b.quality >= HELD_QUALITY])
    return np.searchsorted(a.frame, frames), np.searchsorted(b.frame, frames)


def correlations(live: Curves, offline: Curves) -> dict[str, float]:
    """Of each curve, at no lag; nan where it does nothing."""
    result = {}
    for name, curve in offline.items():
        is_moving = curve.std() >= MOVES and live[name].std() > 1e-9
        result[name] = float(np.corrcoef(live[name], curve)[0, 1]) if is_moving else np.nan
    return result


def lag_of(live: Curves, offline: Curves) -> float:
    """Frames by which live curves come later, by all that move: the peak of the correlation of
    their changes, between frames by a parabola."""
    total = np.zeros(1 + LATEST - EARLIEST)
    for name, curve in offline.items():
        if curve.std() < MOVES or live[name].std() <= 1e-9:
            continue
        a, b = np.diff(live[name]), np.diff(curve)
        inner = b[-EARLIEST : len(b) - LATEST]
        for i, lag in enumerate(range(EARLIEST, LATEST + 1)):
            other = a[lag - EARLIEST : lag - EARLIEST + len(inner)]
            total[i] += np.corrcoef(other, inner)[0, 1]
    peak = int(np.clip(np.argmax(total), 1, len(total) - 2))
    before, at, after = total[peak - 1 : peak + 2]
    return EARLIEST + peak + 0.5 * (before - after) / (before - 2 * at + after)


def jitter_at_rest(runs: NDArray[np.int64], scored: Performance) -> float:
    """Standard deviation of a muscle about a steady motion, where the picture of the face keeps
    still; root mean square of all muscles, the median of the runs (R x RUN, frames)."""
    usable = runs[np.isin(runs, scored.frame).all(axis=1)]
    rows = np.searchsorted(scored.frame, usable)
    variance = jitter(scored.activations[rows][..., None])[..., 0]
    return float(np.sqrt(np.median(variance.mean(axis=1))))
