# SPDX-License-Identifier: GPL-3.0-or-later
"""Who is filmed how. People for tuning and held-out people never meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..motion import HeadMotion, Phase, rotation
from ..recipes import Recipe
from .shapes import NAMES

FPS = 30
REST, SLOT, NUM_SLOTS, TAIL = 0.4, 0.7, 2, 0.1  # seconds
NUM_FRAMES = round((REST + SLOT * NUM_SLOTS + TAIL) * FPS)
SIZES = {"320x240": (320, 240), "640x480": (640, 480)}
HEADS = ("frontal", "turned")
FACE_WIDTH_SHARE = 0.36  # of the picture's width
SLIGHT = HeadMotion(yaw=3, pitch=1.5, roll=1.5, sideways=0.003, nearer=0.008)
RAISED = 0.02  # metres: the chin is in the picture
LARGEST_TURN = (30.0, 40.0)  # degrees


@dataclass(frozen=True)
class Lamp:
    """toward: to the lamp, x right, y up, z to the camera; its width seen from the face."""

    toward: tuple[float, float, float]
    strength: float
    width_degrees: float


LIGHTS = {
    "soft": (Lamp((0.3, 0.6, 0.8), 2.0, 60.0),),
    "lamps": (
        *(Lamp((0.9, 0.3, 0.5), 1.1, 12.0), Lamp((-0.8, 0.5, 0.6), 0.8, 12.0)),
        Lamp((0.1, 0.9, 0.4), 0.7, 25.0),
    ),
    "side": (Lamp((0.9, 0.25, 0.45), 1.7, 30.0), Lamp((-0.6, 0.2, 0.9), 0.5, 40.0)),
}


@dataclass(frozen=True)
class Film:
    """One person, two expressions, one way of moving the head. gloss: share of specular light."""

    name: str
    seed: int
    head: str  # of HEADS
    expressions: tuple[str, str]
    light: str  # of LIGHTS
    gloss: float
    roughness: float
    focal_ratio: float
    camera_error: tuple[float, float]  # of the principal point, in image widths
    noise_sd: float
    crf: int

    def recipe(self, size: str) -> Recipe:
        width, height = SIZES[size]
        return Recipe(
            name=f"{self.name}-{size}",
            kind="units",
            seed=self.seed,
            num_frames=NUM_FRAMES,
            image_size=(width, height),
            fps=FPS,
            face_width_px=FACE_WIDTH_SHARE * width,
            focal_ratio=self.focal_ratio,
            noise_sd=self.noise_sd,
            blur_px=0.5 * width / 320,
            crf=self.crf,
        )

    def phases(self) -> tuple[Phase, ...]:
        quick = {"rise": 0.25, "hold": 0.12, "release": 0.06, "relaxation": 0.1}
        starts = (REST + SLOT * slot for slot in range(NUM_SLOTS))
        shown = zip(self.expressions, starts, strict=True)
        return tuple(Phase(name, 1.0, start, **quick) for name, start in shown)

    def spans(self) -> list[tuple[int, int]]:
        """First and last frame (from 1) of every expression."""
        starts = [round((REST + SLOT * i) * FPS) + 1 for i in range(NUM_SLOTS)]
        return [(start, start + round(SLOT * FPS) - 1) for start in starts]

    def poses(self, times: NDArray, distance: float) -> NDArray[np.float64]:
        """camera_from_head N x 4 x 4. Turned: from the camera to one side, and stays there."""
        poses = SLIGHT.poses(times, distance, self.seed)
        poses[:, 1, 3] -= RAISED
        if self.head == "turned":
            rng = np.random.default_rng([self.seed, 74])
            turn = rng.choice((-1, 1)) * rng.uniform(*LARGEST_TURN)
            share = np.clip((times - 0.1) / 0.6, 0, 1)
            for pose, angle in zip(poses, turn * share**2 * (3 - 2 * share), strict=True):
                pose[:3, :3] = pose[:3, :3] @ rotation(np.radians(angle), 0, 0)
        return poses


def films(first_seed: int, count: int, prefix: str) -> tuple[Film, ...]:
    """Every person near-frontal and turned, with expressions, light and camera of their own."""
    made = []
    for number in range(count):
        rng = np.random.default_rng([first_seed + number, 75])
        for turn, head in enumerate(HEADS):
            order = [NAMES[(number + turn + 3 * k) % len(NAMES)] for k in range(2)]
            made.append(
                Film(
                    name=f"{prefix}-{number}-{head}",
                    seed=first_seed + number,
                    head=head,
                    expressions=(order[0], order[1]),
                    light=tuple(LIGHTS)[(number + turn) % len(LIGHTS)],
                    gloss=float(rng.uniform(0.03, 0.09)),
                    roughness=float(rng.uniform(0.3, 0.45)),
                    focal_ratio=float(rng.uniform(1.1, 1.5)),
                    camera_error=(float(rng.normal(0, 0.006)), float(rng.normal(0, 0.006))),
                    noise_sd=float(rng.uniform(1.5, 3)),
                    crf=int(rng.integers(18, 23)),
                )
            )
    return tuple(made)


SETS = {
    "held-out": films(950, 3, "foreign"),
    "tuning": films(930, 2, "foreign-tuning"),
    "small": films(920, 1, "foreign-small")[:1],
}
