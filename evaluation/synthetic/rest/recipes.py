# SPDX-License-Identifier: GPL-3.0-or-later
"""Who is filmed for the search of a frame at rest, and how each film is shown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..expressions.recipes import EXPRESSIONS, HEADS, any_camera, phases_of
from ..recipes import Recipe

FPS = 30
NUM_AT_REST = 10  # frames, before the first expression
SLOT = 0.42  # seconds from one expression to the next, which comes before the face is at rest
NUM_EXPRESSIONS = 3
NUM_FRAMES = NUM_AT_REST + round(NUM_EXPRESSIONS * SLOT * FPS)


@dataclass(frozen=True)
class Showing:
    """One way to show a film."""

    kind: str
    backward: bool = False  # so that the rest comes last
    bit_rate: int | None = None  # bits a second; an encoder begins blind and blocky


SHOWINGS = (
    Showing("begins at rest"),
    Showing("begins at rest, blocky", bit_rate=90_000),
    Showing("ends at rest", backward=True),
)


def _films(first_seed: int, count: int, prefix: str) -> tuple[Recipe, ...]:
    return tuple(_film(first_seed + i, f"{prefix}-{i:02d}", i) for i in range(count))


def _film(seed: int, name: str, number: int) -> Recipe:
    rng = np.random.default_rng([seed, 67])
    phases = [
        phase
        for slot in range(NUM_EXPRESSIONS)
        for phase in phases_of(
            "units",
            EXPRESSIONS[(number + 4 * slot) % len(EXPRESSIONS)],
            NUM_AT_REST / FPS + SLOT * slot,
            rng,
        )
    ]
    return Recipe(
        name=name,
        kind="units",
        seed=seed,
        num_frames=NUM_FRAMES,
        phases=tuple(phases),
        head_motion=HEADS[("frontal", "moving")[number % 2]],
        fps=FPS,
        **any_camera(rng),
    )


# People of no other set.
SETS = {
    "held-out": _films(800, 12, "rest"),
    "tuning": _films(760, 6, "rest-tuning"),
    "small": _films(760, 1, "rest-tuning"),
}
