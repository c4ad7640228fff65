# SPDX-License-Identifier: GPL-3.0-or-later
"""Squares about drawn people's faces, bare and with something before them, and what is covered."""

from __future__ import annotations

import numpy as np
from PIL import Image

from ..eyes_and_lips.crops import Shots, Square, filmed, jittered, square_round, turned
from . import occluders

SIDE, CELLS = 96, 24
DRAWN = 192  # pixels of the square in which occluders are painted
POINT, LENGTH = (0.0, -0.0014, 0.08), 0.19  # metres, head frame: the square's middle, and its side
SIDES = (44.0, 192.0)  # pixels of a filmed square
JITTER = {"center": 0.04, "side": 0.07, "roll": 4.0}  # s.d.: sides of the square, share, degrees
EDGE = 80  # pixels by which a shot is continued
BARE, TWO, SHADOWED = 0.33, 0.12, 0.3  # share of the pictures


def square_of(shots: Shots, shot: int) -> Square:
    """Where the pose places the square of the face."""
    return square_round(shots, shot, np.array(POINT), LENGTH)


def sample(
    shots: Shots, shot: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A picture (SIDE x SIDE x 3, uint8), covered shares of its cells, and how far each is face."""
    square = jittered(square_of(shots, shot), rng, JITTER)
    # What the picture cuts off goes on as at its edge
    drawn = np.pad(shots.frames[shot], ((EDGE, EDGE), (EDGE, EDGE), (0, 0)), mode="edge")
    square = Square(square.center + EDGE, square.side, square.roll)
    frame = turned(Image.fromarray(drawn), square, DRAWN, rng.random() < 0.5)
    face = frame[..., 3:].astype(np.float32) / 255
    behind = occluders.textured(DRAWN, rng.uniform(5, 240, 3), rng, rng.uniform(0.02, 0.5))
    picture = frame[..., :3] * face + np.clip(behind, 0, 255) * (1 - face)
    solid = face[..., 0] > 0.9
    skin = np.median(frame[solid][:, :3], axis=0) if solid.any() else np.full(3, 128.0)
    if rng.random() < SHADOWED:
        picture = occluders.shadowed(picture, rng)
    cover = np.zeros((DRAWN, DRAWN))
    if rng.random() > BARE:
        for _ in range(1 + (rng.random() < TWO)):
            picture, own = occluders.painted(picture, skin.astype(np.float64), rng)
            cover = np.maximum(cover, own)
    wanted = np.exp(rng.uniform(*np.log(SIDES)))
    seen, _ = filmed(np.clip(picture, 0, 255), min(1.0, wanted / DRAWN), rng)
    shown = Image.fromarray(seen).resize((SIDE, SIDE), Image.Resampling.BILINEAR)
    return np.asarray(shown), _by_cell(cover), _by_cell(face[..., 0])


def _by_cell(values: np.ndarray) -> np.ndarray:
    step = DRAWN // CELLS
    return values.reshape(CELLS, step, CELLS, step).mean((1, 3)).astype(np.float32)
