# SPDX-License-Identifier: GPL-3.0-or-later
"""Who shows what, when it begins, how it rises, and how much later a second group follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..expressions.recipes import any_camera
from ..motion import HeadMotion
from ..recipes import Recipe
from .firing import Firing

FPS = 30
NUM_FRAMES = 102
STARTS = (0.8, 2.1)  # seconds at which the two expressions begin, about
# First group's muscles, then those of the second one, each with its amplitude
EXPRESSIONS = {
    "smile": (
        {"zygomaticus_major": 0.8, "zygomaticus_minor": 0.6, "levator_anguli_oris": 0.3},
        {"orbicularis_oculi_inferior": 0.7, "orbicularis_oculi_lateral": 0.4},
    ),
    "brow raise": (
        {"frontalis_medial": 0.9, "frontalis_middle": 0.8, "frontalis_lateral": 0.6},
        {"depressor_anguli_oris": 0.6, "depressor_labii_inferioris": 0.5},
    ),
}
GROUPS = {"smile": (1, 7), "brow raise": (5, 3)}
CONDITIONS = ("delayed", "together", "alone")
DELAY = 3  # frames, of `delayed`
HEAD = HeadMotion(yaw=5, pitch=2.5, roll=2, sideways=0.005, nearer=0.012)
SIDES = (".L", ".R")


@dataclass(frozen=True)
class TimedClip:
    """One person with both expressions, the second group late, at once or silent in both."""

    recipe: Recipe
    condition: str


def timed_clip(seed: int, name: str, condition: str) -> TimedClip:
    rng = np.random.default_rng([seed, 71])
    firings = []
    for expression, about in zip(EXPRESSIONS, STARTS, strict=True):
        first, second = EXPRESSIONS[expression]
        timing = {
            "rise": float(rng.uniform(8, 14)) / FPS,
            "exponent": float(rng.choice((-1, 1)) * rng.uniform(1.5, 3)),
            "hold": float(rng.uniform(4, 8)) / FPS,
            "release": float(rng.uniform(2, 3.5)) / FPS,
            "relaxation": float(rng.uniform(8, 11)) / FPS,
            "relaxed_share": 0.25,
        }
        start = about + float(rng.uniform(0, 3)) / FPS
        firings += _both_sides(first, start, timing)
        if condition != "alone":
            late = DELAY / FPS if condition == "delayed" else 0.0
            firings += _both_sides(second, start + late, timing)
    recipe = Recipe(
        name=name,
        kind="muscles",
        seed=seed,
        num_frames=NUM_FRAMES,
        phases=tuple(firings),
        head_motion=HEAD,
        fps=FPS,
        **any_camera(rng),
    )
    return TimedClip(recipe, condition)


def _both_sides(muscles: dict[str, float], start: float, timing: dict[str, float]) -> list[Firing]:
    return [
        Firing(f"{muscle}{side}", amplitude, start, **timing)
        for muscle, amplitude in muscles.items()
        for side in SIDES
    ]


def _clips(first_seed: int, count: int, prefix: str) -> tuple[TimedClip, ...]:
    return tuple(
        timed_clip(first_seed + i, f"{prefix}-{i:02d}", CONDITIONS[i % len(CONDITIONS)])
        for i in range(count)
    )


# People of no other set: expressions have those from 400 on, 430 to 460 are nobody's
SETS = {"held-out": _clips(440, 12, "timing"), "tuning": _clips(80, 6, "timing-tuning")}
