# SPDX-License-Identifier: GPL-3.0-or-later
"""How truth moves in time: phases of an expression and slow motion of the head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RISE_EXPONENT = 2.0
RELAXED_SHARE = 0.25


@dataclass(frozen=True)
class Phase:
    """One application, hold and release of a control; times in seconds from the first frame."""

    control: str
    amplitude: float
    start: float
    rise: float = 0.35
    hold: float = 0.4
    release: float = 0.15
    relaxation: float = 0.35

    def values(self, times: np.ndarray) -> np.ndarray:
        """Exponential rise, hold, then a fall with a fast and a slow part (N,)."""
        s = np.clip((times - self.start) / self.rise, 0, 1)
        applied = np.expm1(RISE_EXPONENT * s) / np.expm1(RISE_EXPONENT)
        since = np.clip(times - self.start - self.rise - self.hold, 0, None)
        fast, slow = np.exp(-since / self.release), np.exp(-since / self.relaxation)
        return self.amplitude * applied * ((1 - RELAXED_SHARE) * fast + RELAXED_SHARE * slow)


def control_values(phases: tuple[Phase, ...], names: list[str], times: np.ndarray) -> np.ndarray:
    """Values (N, number of names) of all controls; phases of one control add up to 1 at most."""
    values = np.zeros((len(times), len(names)))
    for phase in phases:
        values[:, names.index(phase.control)] += phase.values(times)
    return np.clip(values, 0, 1)


@dataclass(frozen=True)
class HeadMotion:
    """Largest excursions of the head from where it starts: degrees and metres."""

    yaw: float = 8.0
    pitch: float = 4.0
    roll: float = 3.0
    sideways: float = 0.008
    nearer: float = 0.02

    def poses(self, times: np.ndarray, distance: float, seed: int) -> np.ndarray:
        """camera_from_head (N,4,4); camera: x right, y down, z forward.

        Two slow sines an axis with seeded phases, faded in over the first half second.
        """
        rng = np.random.default_rng([seed, 21])
        limits = (self.pitch, self.yaw, self.roll, self.sideways, 0.7 * self.sideways, self.nearer)
        fade = np.clip(times / 0.5, 0, 1) ** 2
        swing = np.stack([limit * fade * _two_sines(times, rng) for limit in limits], axis=1)
        start = rng.uniform(-1, 1, 3) * (2.0, 3.0, 1.5)
        poses = np.tile(np.eye(4), (len(times), 1, 1))
        for i, row in enumerate(swing):
            pitch, yaw, roll = np.radians(row[:3] + start)
            poses[i, :3, :3] = np.diag((1, -1, -1)) @ rotation(yaw, pitch, roll)
            poses[i, :3, 3] = row[3:] + np.array([0, 0.03, distance])
        return poses


def _two_sines(times: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    phases = rng.uniform(0, 2 * np.pi, 2)
    rates = 2 * np.pi * np.array([rng.uniform(0.25, 0.4), rng.uniform(0.55, 0.8)])
    sines = np.sin(rates * times[:, None] + phases) - np.sin(phases)
    return np.clip(sines @ (0.7, 0.3), -1.2, 1.2)


def rotation(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """Rz(roll) Rx(pitch) Ry(yaw) in head axes (x: subject's left, y: up, z: forward)."""
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (np.cos, np.sin))
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    return about_z @ about_x @ about_y
