# SPDX-License-Identifier: GPL-3.0-or-later
"""A small made-up performance with eyes: two balls of points that turn before the patch."""

import dataclasses

import numpy as np
from mimetic.performance.gaze import GAZE
from sample_performance import make_performance

LIDS = ("lid_upper.L", "lid_upper.R")
RADIUS = 0.012


def make_looking(**changes):
    """A patch with two balls of points behind it for eyes, that look about."""
    base = make_performance()
    n = base.num_frames
    rng = np.random.default_rng(2)
    centers = np.array([[0.03, 0.02, 0.07], [-0.03, 0.02, 0.07]])
    balls = rng.normal(size=(2, 20, 3))
    balls *= RADIUS / np.linalg.norm(balls, axis=2, keepdims=True)
    ball = (centers[:, None] + balls).reshape(-1, 3)
    eye_of = np.r_[np.zeros(len(base.neutral_vertices), int), np.repeat([1, 2], 20)]

    def longer(modes):
        return np.concatenate([modes, np.zeros((len(modes), 40, 3))], axis=1)

    lid_modes = np.zeros((2, len(eye_of), 3))
    lid_modes[0, :10, 1] = lid_modes[1, 10:20, 1] = -0.01
    angles = np.stack([np.linspace(-30, 25, n), np.linspace(20, -25, n)] * 2, axis=1)
    values = {
        "muscle_modes": longer(base.muscle_modes),
        "articulators": [*base.articulators, *LIDS, *GAZE],
        "articulator_values": np.hstack([base.articulator_values, np.full((n, 2), 0.2), angles]),
        "articulator_modes": np.concatenate(
            [longer(base.articulator_modes), lid_modes, np.zeros((4, len(eye_of), 3))]
        ),
        "neutral_vertices": np.vstack([base.neutral_vertices, ball]),
        "eye_centers": centers,
        "iris_centers": centers + np.array([0, 0, RADIUS]),
        "eye_of_vertex": eye_of,
        "lid_following": np.tile([0.02, -3.0], (2, 1)),
    }
    return dataclasses.replace(base, **(values | changes))
