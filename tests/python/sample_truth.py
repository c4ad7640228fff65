# SPDX-License-Identifier: GPL-3.0-or-later
"""Truth that a made-up performance explains exactly."""

import numpy as np
from mimetic.score.prediction import follow
from mimetic.score.truth import Truth


def make_truth(performance, num_points=40, **changes):
    """Truth that a performance explains exactly: points of its own surface."""
    rng = np.random.default_rng(3)
    middle = performance.image_size / 2
    pixels = middle + rng.uniform(-25, 25, (num_points, 2))
    followed = follow(performance, pixels)
    values = {
        "frame": performance.frame,
        "fps": performance.fps,
        "image_size": performance.image_size,
        "intrinsics": performance.intrinsics,
        "head_pose": performance.head_pose,
        "points": followed.points,
        "tracks": followed.tracks,
        "visible": np.ones(followed.tracks.shape[:2], bool),
        "muscles": performance.muscles,
        "groups": performance.groups,
        "activations": performance.activations,
    }
    return Truth(**(values | changes))
