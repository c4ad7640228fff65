# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands behind a face or in place of one, and what a cheap camera makes of it."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image, ImageFilter

from ..footage import background
from ..noise import ValueNoise
from ..recipes import Recipe
from .sitters import IMAGE_SIZE


def photographed(picture: np.ndarray, seed: int) -> np.ndarray:
    """Exposure, blur, noise and JPEG (H,W,3) uint8 of a picture (H,W,3) in grey levels."""
    rng = np.random.default_rng([seed, 61])
    exposed = np.clip(picture * rng.uniform(0.6, 1.2) + rng.uniform(-8, 12), 0, 255)
    soft = Image.fromarray(exposed.astype(np.uint8)).filter(
        ImageFilter.GaussianBlur(rng.uniform(0, 1.3))
    )
    noise_sd = rng.uniform(1, 8)
    noisy = np.asarray(soft, float) + rng.normal(0, noise_sd, (*picture.shape[:2], 1))
    noisy += rng.normal(0, 0.5 * noise_sd, picture.shape)
    packed = io.BytesIO()
    plain = Image.fromarray(np.clip(np.round(noisy), 0, 255).astype(np.uint8))
    plain.save(packed, "JPEG", quality=int(rng.integers(35, 93)))
    return np.asarray(Image.open(packed).convert("RGB"))


def over(rgba: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """A rendered figure (H,W,4) uint8 before a background (H,W,3)."""
    cover = rgba[..., 3:].astype(np.float32) / 255
    return behind + cover * (rgba[..., :3] - behind)


def surroundings(seed: int) -> np.ndarray:
    """A room, or a texture (H,W,3), grey levels."""
    return room(seed) if seed % 2 else texture(seed)


def room(seed: int) -> np.ndarray:
    """A wall with a door frame, a poster and things of plain colour on it."""
    rng = np.random.default_rng([seed, 62])
    wall = background(Recipe("still", "still", seed, 1, image_size=IMAGE_SIZE)).copy()
    x, y = np.meshgrid(*(np.arange(n, dtype=float) for n in IMAGE_SIZE))
    for _ in range(int(rng.integers(3, 9))):
        center, size = rng.uniform((0, 0), IMAGE_SIZE), rng.uniform(8, 60, 2)
        across, down = np.abs(x - center[0]) / size[0], np.abs(y - center[1]) / size[1]
        round_one = rng.random() < 0.5
        inside = across**2 + down**2 < 1 if round_one else np.maximum(across, down) < 1
        shade = 1 + 0.25 * (x - center[0]) / size[0] * rng.choice((-1, 1))
        wall[inside] = (shade[..., None] * rng.uniform(20, 220, 3))[inside]
    return np.clip(wall, 0, 255)


def texture(seed: int) -> np.ndarray:
    """Coloured noise over several octaves, stripes or checks."""
    rng = np.random.default_rng([seed, 63])
    noise = ValueNoise(seed + 9)
    x, y = np.meshgrid(*(np.arange(n, dtype=float) for n in IMAGE_SIZE))
    places = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    periods = rng.uniform((40, 14, 5), (90, 30, 10))
    grain = sum(
        weight * noise(places + 7 * i, float(period)).reshape(x.shape)
        for i, (weight, period) in enumerate(zip((0.6, 0.5, 0.35), periods, strict=True))
    )
    if rng.random() < 0.5:
        angle, period = rng.uniform(0, np.pi), rng.uniform(9, 40)
        waves = np.sin(2 * np.pi * (x * np.cos(angle) + y * np.sin(angle)) / period)
        if rng.random() < 0.5:
            waves = waves * np.sin(2 * np.pi * (y * np.cos(angle) - x * np.sin(angle)) / period)
        grain = 0.4 * grain + 0.6 * np.tanh(3 * waves)
    dark, light = rng.uniform(15, 120, 3), rng.uniform(110, 245, 3)
    return np.clip(dark + (grain[..., None] * 0.5 + 0.5) * (light - dark), 0, 255)


def jumbled(picture: np.ndarray, seed: int) -> np.ndarray:
    """The picture's tiles of 20 pixels in random order: a face's tones without a face."""
    tile = 20
    height, width = picture.shape[0] // tile, picture.shape[1] // tile
    cut = picture.reshape(height, tile, width, tile, 3).transpose(0, 2, 1, 3, 4)
    order = np.random.default_rng([seed, 64]).permutation(height * width)
    mixed = cut.reshape(-1, tile, tile, 3)[order].reshape(height, width, tile, tile, 3)
    return mixed.transpose(0, 2, 1, 3, 4).reshape(picture.shape)
