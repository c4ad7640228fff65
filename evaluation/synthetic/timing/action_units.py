# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces moved by an action unit's vectors alone, up and down in straight lines: what FACS is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.muscles.action_units import action_unit
from mimetic.template.face_template import FaceTemplate

from ..expressions.recipes import any_camera
from ..motion import control_values
from ..recipes import Recipe
from ..scene import Motion
from .recipes import FPS, HEAD

NUM_FRAMES = 60
UNITS = ("AU2", "AU12")


@dataclass(frozen=True)
class Ramp:
    """Straight up, held, straight down; seconds."""

    control: str
    amplitude: float
    start: float
    rise: float
    hold: float
    fall: float

    def values(self, times: np.ndarray) -> np.ndarray:
        end = self.start + self.rise + self.hold + self.fall
        return self.amplitude * np.interp(
            times,
            (self.start, self.start + self.rise, end - self.fall, end),
            (0.0, 1.0, 1.0, 0.0),
        )


def unit_motion(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> Motion:
    """Intensities over time and the displacements they cause; neutral V x 3, metres."""
    names = sorted({phase.control for phase in recipe.phases})
    values = control_values(recipe.phases, names, np.arange(recipe.num_frames) / recipe.fps)
    modes = np.stack([action_unit(name, neutral, template).mode for name in names])
    moved = np.tensordot(values, modes, axes=1)
    return Motion(names, values, np.zeros(len(names), int), moved)


def _recipes(first_seed: int, count: int, prefix: str) -> tuple[Recipe, ...]:
    recipes = []
    for i in range(count):
        rng = np.random.default_rng([first_seed + i, 73])
        ramp = Ramp(UNITS[i % len(UNITS)], 0.8, 0.7, *(rng.uniform(9, 12, 3) / FPS).round(4))
        recipes.append(
            Recipe(
                name=f"{prefix}-{i:02d}",
                kind="units",
                seed=first_seed + i,
                num_frames=NUM_FRAMES,
                phases=(ramp,),
                head_motion=HEAD,
                fps=FPS,
                **any_camera(rng),
            )
        )
    return tuple(recipes)


SETS = {"held-out": _recipes(455, 4, "facs"), "tuning": _recipes(88, 2, "facs-tuning")}
