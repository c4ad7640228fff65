# SPDX-License-Identifier: GPL-3.0-or-later
"""Time of footage against time of a scene that plays at a rate of its own."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput

# Rates arrive in single precision (24 / 1.001 as 23.976023); broadcast rates are exact fractions
RATE_TOLERANCE = 1e-5
SLOWEST, FASTEST = 1e-5, 1e6  # frames a second: one a day, a million a second
SINGLE_PRECISION = 5e-7  # of a rate: a scene's base is rounded
LAST_FRAME = 2**31 - 1  # of footage: a year at 60 a second
LAST_SCENE_FRAME = 1_048_574  # on Blender's timeline
HIGHEST_SCENE_RATE = 32767  # whole frames a second that a scene can have before its base


@dataclass(frozen=True)
class FrameSteps:
    """Which footage frame whole scene frames show: see `frame_steps`."""

    scene_frames: NDArray[np.int64]  # K
    offsets: NDArray[np.int64]  # K, to add to the frame that plain counting would show


def check_rate(what: str, frames_a_second: float) -> None:
    """Raises InvalidInput unless the rate is one that footage and scenes can have."""
    if not SLOWEST <= frames_a_second <= FASTEST:
        raise InvalidInput(
            f"{what} is {frames_a_second}; it must be {SLOWEST:g} to {FASTEST:g} frames a second"
        )


def exact_rate(frames_a_second: float) -> Fraction:
    """The rate meant by a rounded number: 25, 24000/1001, ...; else the number itself.

    Raises InvalidInput unless the rate lies in SLOWEST to FASTEST.
    """
    check_rate("a frame rate", frames_a_second)
    for exact in (
        Fraction(round(frames_a_second)),
        Fraction(1000 * round(frames_a_second * 1.001), 1001),
    ):
        if abs(float(exact) - frames_a_second) <= RATE_TOLERANCE * frames_a_second:
            return exact
    return Fraction(frames_a_second).limit_denominator(1_000_000)


def _footage_step(clip_rate: float, scene_rate: float) -> Fraction:
    """Footage frames a scene frame; 1 where the rates differ by the rounding of a scene's alone."""
    step = exact_rate(clip_rate) / exact_rate(scene_rate)
    return Fraction(1) if abs(float(step) - 1) < SINGLE_PRECISION else step


def is_same_rate(clip_rate: float, scene_rate: float) -> bool:
    """Whether a scene shows footage frame by frame. Raises InvalidInput as `exact_rate`."""
    return _footage_step(clip_rate, scene_rate) == 1


def scene_frames(
    frames: ArrayLike,
    clip_rate: float,
    scene_rate: float,
    frame_start: int = 1,
    frame_offset: int = 0,
) -> NDArray[np.float64]:
    """Where footage frames fall on a scene's timeline, so that seconds stay seconds.

    frames: N numbers in the footage, first = 1; clip_rate, scene_rate: frames a second;
    frame_start: the scene frame that shows the clip's first frame; frame_offset: frames of the
    footage that the clip skips, as a movie clip in Blender has it.
    returns: N scene frames, fractional where the rates differ. Raises InvalidInput where they fall
    off the end of a timeline.
    """
    step = float(1 / _footage_step(clip_rate, scene_rate))
    elapsed_frames = np.asarray(frames, dtype=np.float64) - 1 - frame_offset
    exact = frame_start + elapsed_frames * step
    if exact.size and np.abs(exact).max() > LAST_SCENE_FRAME:
        raise InvalidInput(
            f"footage of {clip_rate:g} frames a second falls on scene frames up to "
            f"{np.abs(exact).max():.0f} at {scene_rate:g} a second; a timeline ends at "
            f"{LAST_SCENE_FRAME}: capture a part of the footage, or give the scene a lower rate"
        )
    return exact


def footage_frames(
    scene: ArrayLike,
    clip_rate: float,
    scene_rate: float,
    frame_start: int = 1,
    frame_offset: int = 0,
) -> NDArray[np.float64]:
    """The inverse of `scene_frames`: footage frames, fractional, at scene frames."""
    step = float(_footage_step(clip_rate, scene_rate))
    elapsed_frames = np.asarray(scene, dtype=np.float64) - frame_start
    return 1 + frame_offset + elapsed_frames * step


def frame_steps(
    frames: ArrayLike,
    clip_rate: float,
    scene_rate: float,
    frame_start: int = 1,
    frame_offset: int = 0,
) -> FrameSteps | None:
    """How a player that counts one footage frame a scene frame must jump to keep to the seconds.

    Counting shows footage frame 1 at `frame_start`. Arguments as of `scene_frames`.
    returns: None where counting is right: at equal rates.
    """
    if is_same_rate(clip_rate, scene_rate):
        return None
    scene_numbers = scene_frames(frames, clip_rate, scene_rate, frame_start, frame_offset)
    shown_at = np.arange(np.floor(scene_numbers[0]), np.ceil(scene_numbers[-1]) + 1).astype(
        np.int64
    )
    footage_numbers = footage_frames(shown_at, clip_rate, scene_rate, frame_start, frame_offset)
    # The frame on screen is the last that has begun; 1e-6 keeps whole frames whole
    footage_numbers = np.clip(
        np.floor(footage_numbers + 1e-6), np.min(frames), np.max(frames)
    ).astype(np.int64)
    return FrameSteps(shown_at, footage_numbers - (shown_at - frame_start + 1))


@dataclass(frozen=True)
class SceneRate:
    """A scene's rate as a whole number over a base: fps / fps_base frames a second."""

    fps: int
    fps_base: float


def scene_rate(clip_rate: float) -> SceneRate:
    """The rate at which a scene of its own shows footage frame by frame: 29.97 is 30 / 1.001."""
    exact = exact_rate(clip_rate)
    fps = min(max(1, round(exact)), HIGHEST_SCENE_RATE)
    return SceneRate(fps, float(fps / exact))
