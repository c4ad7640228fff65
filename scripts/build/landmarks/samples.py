# SPDX-License-Identifier: GPL-3.0-or-later
"""Shots made into what the cascade learns from: photographed, partly hidden, with a start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from scripts.build.eigenspaces.scenes import photographed, spectacled

from .shots import Shots
from .sitters import PX_PER_IPD, SIDE

GLASSES, HIDDEN, FRINGES, SHADES = 0.12, 0.12, 0.2, 0.35  # parts of the samples
SMALLEST = 0.35  # of the size drawn
START_ERROR, FAR_START_ERROR, FAR = 0.025, 0.07, 0.15  # of a pupil, IPD; part of the samples
VIEW_ERROR = 9.0  # degrees


@dataclass(frozen=True)
class Sample:
    image: np.ndarray  # H x W x 3, uint8
    places: np.ndarray  # L x 2, true
    pupils: np.ndarray  # 2 x 2, left first: where the finder may say they are
    yaw: float  # degrees, true
    seen_yaw: float  # what the finder may say


def sample(shots: Shots, i: int, order: np.ndarray, seed: int) -> Sample:
    """Sample of shot i. order: the landmarks' places in a mirrored picture."""
    rng = np.random.default_rng([seed, i, 91])
    grey, places, pupils = shots.grey[i], shots.places[i], shots.pupils[i]
    yaw = float(shots.yaw[i])
    if seed % 2:
        grey = grey[:, ::-1]
        places, pupils = (p * (-1, 1) + (SIDE - 1, 0) for p in (places[order], pupils[::-1]))
        yaw = -yaw
    grey = _hidden(np.ascontiguousarray(grey), places, pupils, rng)
    scale = rng.uniform(SMALLEST, 1) if rng.random() < 0.6 else 1.0
    side = round(SIDE * scale)
    scale = side / SIDE
    small = np.asarray(Image.fromarray(grey).resize((side, side), Image.Resampling.BOX))
    grey = photographed(small, rng)
    spread = FAR_START_ERROR if rng.random() < FAR else START_ERROR
    pupils = pupils + rng.normal(0, spread * PX_PER_IPD, (2, 2))
    return Sample(
        np.repeat(grey[..., None], 3, axis=2),
        (places + 0.5) * scale - 0.5,
        (pupils + 0.5) * scale - 0.5,
        yaw,
        yaw + rng.normal(0, VIEW_ERROR),
    )


def _hidden(grey: np.ndarray, places, pupils, rng: np.random.Generator) -> np.ndarray:
    """Shade, glasses, hair over the forehead and things before the face."""
    if rng.random() < SHADES:
        cells = np.asarray(
            Image.fromarray(rng.uniform(0.35, 1.3, (4, 4)).astype(np.float32)).resize(
                (SIDE, SIDE), Image.Resampling.BICUBIC
            )
        )
        grey = np.clip(grey * cells, 0, 255).astype(np.uint8)
    if rng.random() < GLASSES:
        grey = spectacled(grey, pupils, rng)
    if rng.random() < FRINGES:
        grey = _fringe(grey, places, pupils, rng)
    if rng.random() < HIDDEN:
        picture = Image.fromarray(grey)
        center, size = places[rng.integers(len(places))], rng.uniform(0.15, 0.6, 2) * PX_PER_IPD
        box = (*(center - size), *(center + size))
        pen = ImageDraw.Draw(picture)
        (pen.ellipse if rng.random() < 0.5 else pen.rectangle)(box, fill=int(rng.integers(256)))
        grey = np.asarray(picture)
    return grey


def _fringe(grey: np.ndarray, places, pupils, rng: np.random.Generator) -> np.ndarray:
    """Long hair: down to a wavy line above the eyes, and beside the face."""
    middle, across = pupils.mean(0), np.linalg.norm(pupils[0] - pupils[1])
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
    wave = sum(rng.normal(0, 0.08) * np.sin(k * x / across + rng.uniform(0, 6)) for k in (1, 2, 4))
    edge = middle[1] - across * (rng.uniform(0.5, 1.1) + wave)
    half = np.ptp(places[:, 0]) / 2
    off = np.abs(x - places[:, 0].mean()) / half
    sides = (off > rng.uniform(0.8, 1.0)) & (off < rng.uniform(1.05, 1.4))
    sides &= y < middle[1] + across * rng.uniform(-0.2, 3.5)
    over = (y < edge) & (off < 1.3) | sides
    strands = rng.normal(0, 1, (1, SIDE)) + 0.5 * rng.normal(0, 1, (SIDE, SIDE))
    hair = np.clip(rng.uniform(15, 170) + rng.uniform(2, 14) * strands, 0, 255)
    soft = np.asarray(
        Image.fromarray((255 * over).astype(np.uint8)).filter(ImageFilter.GaussianBlur(1.0)), float
    )
    return (grey + soft / 255 * (hair - grey)).astype(np.uint8)
