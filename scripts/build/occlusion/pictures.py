# SPDX-License-Identifier: GPL-3.0-or-later
"""Squares about drawn people's faces, bare and with something before them, and what is covered."""

from __future__ import annotations

import numpy as np
from PIL import Image

from ..eyes_and_lips.crops import Shots, Square, filmed
from . import occluders

SIDE, CELLS = 96, 24
DRAWN = 192  # pixels of the square in which occluders are painted
POINT, LENGTH = (0.0, -0.0014, 0.08), 0.19  # metres, head frame: the square's middle, and its side
SIDES = (44.0, 192.0)  # pixels of a filmed square
JITTER = {"center": 0.04, "side": 0.07, "roll": 4.0}  # s.d.: sides of the square, share, degrees
EDGE = 80  # pixels
BARE, TWO, SHADOWED = 0.33, 0.12, 0.3  # share of the pictures


def square_of(shots: Shots, shot: int) -> Square:
    pose, focal = shots.head_pose[shot], shots.intrinsics[0, 0]
    at = pose[:3, :3] @ np.array(POINT) + pose[:3, 3]
    center = focal * at[:2] / at[2] + shots.intrinsics[:2, 2]
    across = pose[:2, 0] * at[2] - at[:2] * pose[2, 0]
    return Square(center, LENGTH * focal / at[2], float(np.arctan2(across[1], across[0])))


def turned(image: Image.Image, square: Square, size: int, mirrored: bool) -> np.ndarray:
    axes = square.axes / size
    x = axes[:, 0] * (-1 if mirrored else 1)
    first = square.center + 0.5 - (size / 2) * (x + axes[:, 1])
    data = (x[0], axes[0, 1], first[0], x[1], axes[1, 1], first[1])
    made = image.transform((size, size), Image.Transform.AFFINE, data, Image.Resampling.BILINEAR)
    return np.asarray(made)


def sample(
    shots: Shots, shot: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A picture (SIDE x SIDE x 3, uint8), covered shares of its cells, and how far each is face."""
    square = square_of(shots, shot)
    square = Square(
        square.center + square.side * rng.normal(0, JITTER["center"], 2),
        square.side * float(np.exp(rng.normal(0, JITTER["side"]))),
        square.roll + float(np.radians(rng.normal(0, JITTER["roll"]))),
    )
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
