# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered frames made into footage as a cheap camera would: background, blur, noise, H.264."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe

from .noise import ValueNoise, smoothstep
from .recipes import Recipe


def filmed(frames: np.ndarray, recipe: Recipe) -> np.ndarray:
    """RGB uint8 (N,H,W,3) from the renderer's RGBA uint8 (N,H,W,4, colour not premultiplied)."""
    rng = np.random.default_rng([recipe.seed, 41])
    room = background(recipe)
    filmed = np.empty((*frames.shape[:3], 3), np.uint8)
    for i, frame in enumerate(frames):
        cover = frame[..., 3:].astype(np.float32) / 255
        picture = room + cover * (frame[..., :3] - room)
        picture = _blurred(picture, recipe.blur_px)
        grey = rng.normal(0, 0.8 * recipe.noise_sd, (*picture.shape[:2], 1))
        color = rng.normal(0, 0.6 * recipe.noise_sd, picture.shape)
        filmed[i] = np.clip(np.round(picture + grey + color), 0, 255)
    return filmed


def background(recipe: Recipe) -> np.ndarray:
    """A wall with uneven light, a door frame and a poster (H,W,3), grey levels."""
    width, height = recipe.image_size
    rng = np.random.default_rng([recipe.seed, 42])
    noise = ValueNoise(recipe.seed + 5)
    x, y = np.meshgrid(np.arange(width) / width, np.arange(height) / width)
    places = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    light = 1 + 0.18 * (x - 0.5) * rng.choice((-1, 1)) - 0.2 * y
    light += 0.06 * noise(places, 0.3).reshape(x.shape)
    wall = light[..., None] * rng.uniform(115, 175) * rng.uniform(0.94, 1.0, 3)
    edge = rng.uniform(0.05, 0.2) if rng.random() < 0.5 else rng.uniform(0.8, 0.95)
    wall *= 1 - 0.25 * smoothstep(edge, edge + 0.006, x)[..., None]
    left, top = rng.uniform(0.02, 0.1), rng.uniform(0.04, 0.12)
    inside = (x > left) & (x < left + 0.2) & (y > top) & (y < top + 0.26)
    patches = np.stack([noise(places + 3 * k, 0.05) for k in range(3)], 1).reshape(*x.shape, 3)
    wall[inside] = (150 + 75 * patches)[inside]
    return np.clip(wall, 0, 255).astype(np.float32)


def _blurred(picture: np.ndarray, sigma: float) -> np.ndarray:
    reach = np.arange(-2, 3)
    kernel = np.exp(-(reach**2) / (2 * sigma**2))
    kernel /= kernel.sum()
    for axis in (0, 1):
        width = [(2, 2) if a == axis else (0, 0) for a in range(3)]
        padded = np.pad(picture, width, mode="edge")
        count = picture.shape[axis]
        picture = sum(
            share * np.take(padded, np.arange(count) + k, axis) for k, share in enumerate(kernel)
        )
    return picture


def encode(frames: np.ndarray, path: Path, recipe: Recipe) -> None:
    """Writes H.264 in MP4, 4:2:0, at the recipe's rate factor."""
    height, width = frames.shape[1:3]
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{width}x{height}", "-r", str(recipe.fps), "-i", "-", "-an"]
    command += ["-c:v", "libx264", "-preset", "medium", "-crf", str(recipe.crf)]
    command += ["-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)]
    done = subprocess.run(command, input=frames.tobytes(), capture_output=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"ffmpeg could not write {path}: {done.stderr.decode().strip()}")
