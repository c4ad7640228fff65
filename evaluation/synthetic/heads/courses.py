# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a head goes: along what a real one did, through sweeps of each axis, or to and fro fast."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..motion import rotation

HERE = Path(__file__).resolve().parent
FACES_CAMERA = np.diag((1.0, -1.0, -1.0))
FOREHEAD = np.array([0, 0.03, 0.0])  # metres, camera axes: the head's origin lies under the middle
REST = 0.4  # seconds in which a head looks into the camera before it moves


@dataclass(frozen=True)
class RealCourse:
    """The motion of a tracked head, from knots of yaw, pitch, roll (degrees), x, y, z (metres).

    The knots are six frames apart: `mimetic head --model surface` on real footage, smoothed.
    """

    file: str
    gain: float = 1.0

    def poses(self, times: np.ndarray, distance: float, seed: int) -> np.ndarray:
        """camera_from_head (N,4,4); camera: x right, y down, z forward."""
        knots = self.gain * np.loadtxt(HERE / self.file, delimiter=",", skiprows=1)
        where = np.clip(times * KNOTS_PER_SECOND, 0, len(knots) - 1.001)
        return _poses(_through(knots, where), distance)


KNOTS_PER_SECOND = 5.0


@dataclass(frozen=True)
class Sweeps:
    """One full swing to both sides for each (axis, degrees, seconds), then the same anew."""

    swings: tuple[tuple[str, float, float], ...]
    sideways: float = 0.01  # metres
    nearer: float = 0.03

    def poses(self, times: np.ndarray, distance: float, seed: int) -> np.ndarray:
        rows = np.zeros((len(times), 6))
        start = REST
        for axis, degrees, seconds in self.swings:
            along = np.clip((times - start) / seconds, 0, 1)
            eased = along + EASE * (along**3 * (10 - 15 * along + 6 * along**2) - along)
            rows[:, AXES.index(axis)] += degrees * np.sin(2 * np.pi * eased)
            start += seconds
        since = np.clip(times - REST, 0, None)
        phase = np.random.default_rng([seed, 71]).uniform(1.2, 2.0, 3)
        moves = (self.sideways, 0.6 * self.sideways, self.nearer)
        rows[:, 3:] = moves * np.sin(phase * since[:, None])
        return _poses(rows, distance)

    @property
    def seconds(self) -> float:
        return REST + sum(swing[2] for swing in self.swings)


AXES = ("yaw", "pitch", "roll")
EASE = 0.5  # how much slower a swing begins and ends than a sine


def _through(knots: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Catmull-Rom through knots (M,6) at places (N,) between 0 and M - 1."""
    index = where.astype(int)
    t = (where - index)[:, None]
    padded = np.concatenate([knots[:1], knots, knots[-1:], knots[-1:]])
    a, b, c, d = (padded[index + k] for k in range(4))
    return b + t / 2 * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))


def _poses(rows: np.ndarray, distance: float) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    for pose, (yaw, pitch, roll, *place) in zip(poses, rows, strict=True):
        pose[:3, :3] = FACES_CAMERA @ rotation(*np.radians((yaw, pitch, roll)))
        pose[:3, 3] = np.array(place) + FOREHEAD + (0, 0, distance)
    return poses
