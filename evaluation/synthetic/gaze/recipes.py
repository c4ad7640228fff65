# SPDX-License-Identifier: GPL-3.0-or-later
"""Who looks where, how large the eyes are in the picture, and what the head does meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..motion import HeadMotion
from ..recipes import Recipe
from ..scene import FACE_WIDTH

EYE_WIDTH = 0.030  # metres from corner to corner
FIXATION = 9  # frames
AT_REST = 18  # frames in which the eyes look into the camera, first
NUM_FIXATIONS = 12
LARGEST_YAW, HIGHEST, LOWEST = 25.0, 15.0, -20.0  # degrees of the eyeballs in the head
VERGENCE = 2.0
HEADS = {
    "moving": HeadMotion(),
    "still": HeadMotion(0.0, 0.0, 0.0, 0.0, 0.0),
    "turning": HeadMotion(30.0, 6.0, 3.0, 0.008, 0.02),
}


@dataclass(frozen=True)
class GazeClip:
    """One clip. gaze: `saccades`, or `straight` ahead in the head while that turns."""

    recipe: Recipe
    eye_px: float
    head: str
    gaze: str

    def angles(self) -> np.ndarray:
        """N x 4, degrees: yaw and pitch of the left, then of the right eye."""
        rng = np.random.default_rng([self.recipe.seed, 71])
        way = np.zeros((self.recipe.num_frames, 2))
        if self.gaze == "saccades":
            for number in range(NUM_FIXATIONS):
                first = AT_REST + number * FIXATION
                yaw = rng.uniform(-LARGEST_YAW, LARGEST_YAW)
                way[first : first + FIXATION] = yaw, rng.uniform(LOWEST, HIGHEST)
        yaw, pitch = way.T
        return np.stack([yaw - VERGENCE / 2, pitch, yaw + VERGENCE / 2, pitch], axis=1)


def _clip(seed: int, name: str, eye_px: float, head: str, gaze: str = "saccades") -> GazeClip:
    recipe = Recipe(
        name=f"{name}-{eye_px:.0f}px-{head}",
        kind="still",
        seed=seed,
        num_frames=AT_REST + NUM_FIXATIONS * FIXATION,
        head_motion=HEADS[head],
        image_size=(480, 360) if eye_px > 20 else (320, 240),
        face_width_px=eye_px * FACE_WIDTH / EYE_WIDTH,
    )
    return GazeClip(recipe, eye_px, head, gaze)


def _clips(first_seed: int, count: int, prefix: str) -> tuple[GazeClip, ...]:
    clips = []
    for i in range(count):
        seed, name = first_seed + i, f"{prefix}-{i:02d}"
        clips += [_clip(seed, name, px, ("still", "moving")[i % 2]) for px in (30.0, 15.0)]
    clips.append(_clip(first_seed, f"{prefix}-00", 30.0, "turning", "straight"))
    return tuple(clips)


# People of no other set.
SETS = {
    "held-out": _clips(900, 4, "gaze"),
    "tuning": _clips(880, 2, "gaze-tuning"),
    "small": _clips(880, 1, "gaze-tuning")[:1],
}
