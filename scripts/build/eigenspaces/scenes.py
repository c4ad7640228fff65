# SPDX-License-Identifier: GPL-3.0-or-later
"""Grey photographs of drawn people, and of what is no face."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from mimetic.score.luminance import GREY
from PIL import Image, ImageDraw, ImageFilter

from evaluation.synthetic.stills import photograph
from evaluation.synthetic.stills.sitters import IMAGE_SIZE

from .people import PX_PER_IPD, SIDE


@dataclass(frozen=True)
class Scene:
    grey: np.ndarray  # H x W, uint8
    places: np.ndarray | None = None  # 4 x 2, pixels; None without a face
    ipd: float = 0.0  # pixels


def photographed(grey: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """What a cheap camera makes of grey levels (H,W): uint8."""
    levels = np.asarray(grey, float) * rng.uniform(0.55, 1.2) + rng.uniform(-8, 12)
    picture = Image.fromarray(np.clip(levels, 0, 255).astype(np.uint8))
    soft = np.asarray(picture.filter(ImageFilter.GaussianBlur(float(rng.uniform(0, 1.6)))), float)
    noisy = np.clip(np.round(soft + rng.normal(0, rng.uniform(1, 9), soft.shape)), 0, 255)
    stream = io.BytesIO()
    Image.fromarray(noisy.astype(np.uint8)).save(stream, "JPEG", quality=int(rng.integers(35, 93)))
    return np.asarray(Image.open(stream))


def spectacled(grey: np.ndarray, places: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The face with the rims of glasses before it: grey levels (H,W) uint8."""
    picture = Image.fromarray(grey)
    pen = ImageDraw.Draw(picture)
    left, right = places[0], places[1]
    apart = np.linalg.norm(left - right)
    across = (left - right) / apart
    size = apart * np.array([rng.uniform(0.34, 0.42), rng.uniform(0.22, 0.36)])
    tone, line = int(rng.uniform(10, 120)), max(1, round(apart * rng.uniform(0.02, 0.07)))
    down = np.array([0, rng.uniform(0, 0.1) * apart])
    is_round = rng.random() < 0.5
    for eye, outward in ((left, 1), (right, -1)):
        low, high = eye + down - size, eye + down + size
        if is_round:
            pen.ellipse((*low, *high), outline=tone, width=line)
        else:
            pen.rounded_rectangle((*low, *high), 0.4 * size[1], outline=tone, width=line)
        inner, outer = (
            eye + down - outward * size[0] * across,
            eye + down + outward * size[0] * across,
        )
        middle = (left + right) / 2 + down
        pen.line((*inner, *middle), fill=tone, width=line)
        pen.line((*outer, *(outer + outward * 0.45 * apart * across)), fill=tone, width=line)
    return np.asarray(picture)


def mirrored(grey: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The picture and its places left for right; the pupils change their names."""
    mirror_places = places.copy()
    mirror_places[:, 0] = grey.shape[1] - 1 - mirror_places[:, 0]
    return np.ascontiguousarray(grey[:, ::-1]), mirror_places[[1, 0, 2, 3]]


def empty(seed: int) -> np.ndarray:
    """A room or a texture, grey levels."""
    return photograph.surroundings(seed) @ GREY


def portrait(
    picture: np.ndarray, seed: int, rng: np.random.Generator, places: np.ndarray | None = None
) -> Scene:
    """A drawn picture at any size somewhere in a room or before a texture."""
    scene = np.array(empty(seed))
    side = int(rng.uniform(110, 238))
    scale = side / SIDE
    small = Image.fromarray(picture).resize((side, side), Image.Resampling.LANCZOS)
    left, top = (int(rng.integers(0, whole - side + 1)) for whole in IMAGE_SIZE)
    y, x = np.mgrid[:side, :side] - side / 2
    cover = np.clip(12 * (1 - np.hypot(x, y) / (side / 2)), 0, 1)  # a disc with a soft rim
    behind = scene[top : top + side, left : left + side]
    scene[top : top + side, left : left + side] = behind + cover * (np.asarray(small) - behind)
    places_in_scene = None if places is None else (places + 0.5) * scale - 0.5 + [left, top]
    return Scene(photographed(scene, rng), places_in_scene, PX_PER_IPD * scale)


def jumbled(grey: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The picture's tiles in random order."""
    tile = int(rng.choice([10, 14, 20, 25, 32]))
    rows, cols = grey.shape[0] // tile, grey.shape[1] // tile
    tiles = grey[: rows * tile, : cols * tile].reshape(rows, tile, cols, tile).swapaxes(1, 2)
    mosaic = tiles.reshape(-1, tile, tile)[rng.permutation(rows * cols)]
    mosaic = mosaic.reshape(rows, cols, tile, tile).swapaxes(1, 2)
    return np.ascontiguousarray(mosaic.reshape(rows * tile, cols * tile))
