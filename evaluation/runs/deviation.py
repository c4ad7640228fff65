# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of followed points that add up over the frames of an expression and over people."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from mimetic import _core
from mimetic.score import scores
from mimetic.score.truth import Truth
from numpy.typing import NDArray

from evaluation.runs.methods import Motion


@dataclass(frozen=True)
class Deviation:
    """Errors of N frames and K points, pixels or millimetres."""

    error: NDArray[np.float64]  # N x K
    motion: NDArray[np.float64]  # N x K, what is to be explained
    counted: NDArray[np.bool_]  # N x K
    moving: NDArray[np.bool_]  # N x K, counted and moved by more than a little


@dataclass
class Explained:
    """Sums over frames, clips and people; R2 of all that was added."""

    error: float = 0.0  # squared
    motion: float = 0.0  # squared
    count: int = 0
    distances: list[NDArray[np.float64]] = field(default_factory=list)  # of moving points

    @classmethod
    def of(cls, deviation: Deviation, rows: slice) -> Explained:
        """Of some frames."""
        counts = deviation.counted[rows]
        return cls(
            float((deviation.error[rows][counts] ** 2).sum()),
            float((deviation.motion[rows][counts] ** 2).sum()),
            int(counts.sum()),
            [deviation.error[rows][deviation.moving[rows]]],
        )

    @classmethod
    def all_of(cls, parts: Iterable[Explained]) -> Explained:
        whole = cls()
        for part in parts:
            whole.error += part.error
            whole.motion += part.motion
            whole.count += part.count
            whole.distances += part.distances
        return whole

    @property
    def r2(self) -> float:
        return 1 - self.error / self.motion if self.motion > 0 else math.nan

    @property
    def rms_motion(self) -> float:
        return math.sqrt(self.motion / self.count) if self.count else math.nan

    @property
    def median(self) -> float:
        """Median error of the points that move."""
        distances = np.concatenate(self.distances) if self.distances else np.zeros(0)
        return float(np.median(distances)) if len(distances) else math.nan


def in_image(truth: Truth, motion: Motion) -> Deviation:
    """Against where the true head's motion alone would take the points of the first frame."""
    rigid = scores.project(truth.points[:1], truth.head_pose, truth.intrinsics)
    apart = np.linalg.norm(truth.tracks - rigid, axis=2)
    error = np.linalg.norm(motion.tracks - truth.tracks, axis=2)
    counts = _after_first(truth.visible)
    return Deviation(error, apart, counts, counts & (apart > scores.MOVING_PX))


def in_space(truth: Truth, motion: Motion) -> Deviation:
    """Motion in the head frame, each method's own aligned with the true one by its first points."""
    is_finite = np.isfinite(motion.points).all((0, 2))
    points, method_points = truth.points[:, is_finite], motion.points[:, is_finite]
    rotation = _core.fit_similarity(method_points[0], points[0]).rotation
    motion_of_points = points - points[:1]
    off = (method_points - method_points[:1]) @ rotation.T - motion_of_points
    size = 1000 * np.linalg.norm(motion_of_points, axis=2)
    counts = _after_first(truth.visible[:, is_finite])
    moving = counts & (size > 1000 * scores.MOVING_M)
    return Deviation(1000 * np.linalg.norm(off, axis=2), size, counts, moving)


def _after_first(visible: NDArray[np.bool_]) -> NDArray[np.bool_]:
    counts = visible.copy()
    counts[0] = False
    return counts
