# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand that passes before a face: a palm and four fingers, painted like skin."""

from __future__ import annotations

import numpy as np

from ..noise import ValueNoise, smoothstep

PASSES = 5.0  # seconds from one to the next
LASTS = 2.0  # seconds
SKIN = np.array([196.0, 148.0, 122.0])
# Capsules of the hand: two ends (x right, y down) and a radius, in palm widths
PARTS = np.array(
    [
        [0.0, 0.25, 0.0, 0.9, 0.42],
        [-0.36, -0.1, -0.45, -0.95, 0.11],
        [-0.12, -0.15, -0.15, -1.2, 0.115],
        [0.13, -0.15, 0.15, -1.15, 0.115],
        [0.36, -0.1, 0.42, -0.9, 0.10],
        [0.4, 0.45, 0.85, -0.05, 0.13],
        [0.0, 0.8, 0.1, 3.5, 0.34],
    ]
)


def covered(
    frames: np.ndarray, times: np.ndarray, middle: np.ndarray, width: float, seed: int
) -> np.ndarray:
    """RGBA frames (N,H,W,4) uint8 with the hand in them.

    times (N,) seconds; middle (2,) and width: of the face, pixels.
    """
    made = frames.copy()
    noise = ValueNoise(seed + 9)
    for frame, time in zip(made, times, strict=True):
        since = time % PASSES - (PASSES - LASTS) / 2
        if not 0 < since < LASTS:
            continue
        # From below beside the face, over a cheek and the mouth, and back
        reach = np.sin(np.pi * since / LASTS) ** 0.7
        place = middle + width * np.array([0.75 - 0.5 * reach, 1.6 - 1.35 * reach])
        _paint(frame, place, 0.5 * width, -0.35 + 0.25 * reach, noise)
    return made


def _paint(frame: np.ndarray, place: np.ndarray, palm: float, turn: float, noise) -> None:
    rows, cols = frame.shape[:2]
    x, y = np.meshgrid(np.arange(cols) - place[0], np.arange(rows) - place[1])
    across = (np.cos(turn) * x - np.sin(turn) * y) / palm
    down = (np.sin(turn) * x + np.cos(turn) * y) / palm
    inside = np.max([_depth(across, down, part) for part in PARTS], axis=0)
    cover = smoothstep(-0.7 / palm, 0.7 / palm, inside)
    shown = np.flatnonzero(cover.ravel() > 0)
    at = np.column_stack([across.ravel()[shown], down.ravel()[shown], np.zeros(len(shown))])
    shade = 0.55 + 0.45 * smoothstep(0, 0.12, inside.ravel()[shown])
    grain = 1 + 0.12 * noise.octaves(at, (0.35, 0.12, 0.05))
    color = SKIN * (shade * grain)[:, None]
    share = cover.ravel()[shown, None]
    pixels = frame.reshape(-1, 4)
    under = pixels[shown].astype(float)
    # Where nothing was drawn yet, only the hand's own cover stands before the wall.
    alpha = share[:, 0] + (1 - share[:, 0]) * under[:, 3] / 255
    mixed = share * color + (1 - share) * under[:, 3:] / 255 * under[:, :3]
    pixels[shown, :3] = np.clip(np.round(mixed / alpha[:, None]), 0, 255)
    pixels[shown, 3] = np.round(255 * alpha)


def _depth(x: np.ndarray, y: np.ndarray, part: np.ndarray) -> np.ndarray:
    """How far inside of a capsule, palm widths; below 0 outside."""
    ax, ay, bx, by, radius = part
    ex, ey = bx - ax, by - ay
    along = np.clip(((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey), 0, 1)
    return radius - np.hypot(x - ax - along * ex, y - ay - along * ey)
