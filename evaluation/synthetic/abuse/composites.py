# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to a clip's pictures, and what of the face they still show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..heads.hand import covered
from ..noise import ValueNoise, smoothstep
from .recipes import ENDS, STARTS, AbuseClip, Source

BAR = 0.3  # of the picture's width: 120 pixels of 400
BAR_COLOR = np.array([46.0, 60.0, 52.0])
DARKEST = 0.03
GONE = 0.25  # share of the picture below which a dissolve shows another
GREENS = np.array([[58.0, 92.0, 40.0], [116.0, 150.0, 70.0]])
SKY = np.array([150.0, 190.0, 226.0])
PAN = 30.0  # pixels a second


@dataclass
class Abused:
    """N frames, and by frame: untouched, without the face, where the picture slid to (pixels)."""

    frames: np.ndarray  # N x H x W x 3, uint8
    clean: np.ndarray  # N, bool
    gone: np.ndarray  # N, bool
    shift: np.ndarray  # N x 2


def abused(clip: AbuseClip, frames: np.ndarray, other: np.ndarray) -> Abused:
    """frames, other: N x H x W x 3 uint8, the face of the other where this one has its own."""
    times = np.arange(len(frames)) / clip.source.fps
    count = len(frames)
    made = Abused(
        frames.copy(),
        (times < STARTS) | (times >= ENDS),
        np.zeros(count, bool),
        np.zeros((count, 2)),
    )
    DONE[clip.kind](made, times, clip.source, other)
    return made


def _bar(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """Once from left to right, as tall as the picture."""
    width = source.image_size[0]
    for i in np.flatnonzero(~made.clean):
        along = (times[i] - STARTS) / (ENDS - STARTS)
        left = round(-BAR * width + along * (1 + BAR) * width)
        made.frames[i, :, max(0, left) : max(0, left + round(BAR * width))] = BAR_COLOR


def _hand(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """Over a cheek and the mouth, and away."""
    opaque = np.full((*made.frames.shape[:3], 1), 255, np.uint8)
    x, y, width = source.face
    # The hand comes a second and a half into its time.
    when = np.where(made.clean, 0.0, times - STARTS + 1.5)
    drawn = covered(np.concatenate([made.frames, opaque], 3), when, np.array([x, y]), width, 3)
    made.frames = np.ascontiguousarray(drawn[..., :3])


def _slide(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """The picture leaves to the right before a wall, and comes back."""
    height, width = made.frames.shape[1:3]
    wall = _wall(height, width, 7)
    for i in np.flatnonzero(~made.clean):
        along = (times[i] - STARTS) / (ENDS - STARTS)
        away = round(1.1 * width * np.sin(np.pi * along) ** 2)
        picture = wall.copy()
        if away < width:
            picture[:, away:] = made.frames[i, :, : width - away]
        made.frames[i] = picture
        made.shift[i] = away, 0
        made.gone[i] = source.face[0] + away - source.face[2] / 2 > width


def _cut(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    made.gone |= ~made.clean
    made.frames[made.gone] = other[made.gone]


def _dissolve(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """To another person and back, most of a second each."""
    fade = 0.7
    share = np.clip(np.minimum(times - STARTS, ENDS - times) / fade, 0, 1)
    for i in np.flatnonzero(~made.clean):
        made.frames[i] = np.round((1 - share[i]) * made.frames[i] + share[i] * other[i])
    made.gone |= share > 1 - GONE


def _dark(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """One second, with a quarter of a second to fade on either side."""
    middle = (STARTS + ENDS) / 2
    gain = DARKEST + (1 - DARKEST) * smoothstep(0.5, 0.75, np.abs(times - middle))
    made.clean = gain > 0.999
    for i in np.flatnonzero(~made.clean):
        made.frames[i] = np.round(gain[i] * made.frames[i])


def _lawn(made: Abused, times: np.ndarray, source: Source, other: np.ndarray) -> None:
    """A cut to a drawn meadow over which the camera pans, and back."""
    height, width = made.frames.shape[1:3]
    meadow = _meadow(height, width + round(PAN * (ENDS - STARTS)) + 1)
    for i in np.flatnonzero(~made.clean):
        left = round(PAN * (times[i] - STARTS))
        made.frames[i] = meadow[:, left : left + width]
    made.gone |= ~made.clean


DONE: dict[str, Callable[[Abused, np.ndarray, Source, np.ndarray], None]] = {
    "bar": _bar,
    "hand": _hand,
    "slide": _slide,
    "cut": _cut,
    "dissolve": _dissolve,
    "dark": _dark,
    "lawn": _lawn,
}


def _wall(height: int, width: int, seed: int) -> np.ndarray:
    """H x W x 3 uint8: plaster with stains and a shelf."""
    x, y = np.meshgrid(np.arange(width) / height, np.arange(height) / height)
    at = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    grain = ValueNoise(seed).octaves(at, (0.5, 0.11, 0.03)).reshape(x.shape)
    wall = 150 + 22 * grain
    wall[(y > 0.62) & (y < 0.66)] -= 60
    return np.clip(np.repeat(wall[..., None], 3, 2) * (1, 0.97, 0.9), 0, 255).astype(np.uint8)


def _meadow(height: int, width: int) -> np.ndarray:
    """H x W x 3 uint8: grass in tufts under a flat sky, as a cartoon has it."""
    x, y = np.meshgrid(np.arange(width) / height, np.arange(height) / height)
    at = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    noise = ValueNoise(11)
    tufts = noise.octaves(at, (0.12, 0.04, (0.012, 0.05, 1.0))).reshape(x.shape)
    share = smoothstep(-0.8, 0.8, tufts)[..., None]
    meadow = GREENS[0] + share * (GREENS[1] - GREENS[0])
    hills = 0.16 + 0.05 * np.sin(3.1 * x)
    meadow[y < hills] = SKY
    return np.clip(meadow, 0, 255).astype(np.uint8)
