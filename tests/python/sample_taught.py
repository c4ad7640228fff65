# SPDX-License-Identifier: GPL-3.0-or-later
"""A small made-up taught set: three looks of a mouth and of the left brow."""

import numpy as np
from mimetic.puppet.templates import TaughtSet

CHANNELS = ["puller.L", "puller.R", "raiser.L", "jaw_open"]


def make_taught(num_near=8, noise=0.01, **changes) -> TaughtSet:
    random = np.random.default_rng(4)
    looks = np.array([[0, 0, 0, 0], [0.8, 0.6, 0, 0.1], [0, 0, 0.9, 0.5]], dtype=float)
    parts = ["face"] * 3 + ["mouth"] * 3 + ["brow.L"] * 2
    template_looks = np.array([0, 1, 2, 0, 1, 2, 0, 2])
    boxes = np.array([[4, 4, 40, 50]] * 3 + [[10, 30, 24, 16]] * 3 + [[26, 8, 16, 10]] * 2)
    values, scores = [], []
    for state in looks:
        own = np.array([looks[i] for i in template_looks])
        mouth, brow = [0, 1, 3], [2]
        for _ in range(num_near):
            distance = np.array(
                [
                    np.linalg.norm(
                        (state - other)[{"mouth": mouth, "brow.L": brow}.get(p, [0, 1, 2, 3])]
                    )
                    for p, other in zip(parts, own, strict=True)
                ]
            )
            values.append(state)
            scores.append(1 - 0.4 * distance + random.normal(0, noise, len(parts)))
    fields = {
        "pixel": 1e-3,
        "sides": np.array([-0.03, 0.03, -0.035, 0.035]),
        "looks": ["neutral", "smile", "surprise"],
        "look_frames": np.array([1, 20, 40]),
        "look_values": looks,
        "neutral": 0,
        "channels": CHANNELS,
        "channel_groups": np.array([1, 1, 5, 0]),
        "limits": np.array([[0.0] * 4, [1.0] * 4]),
        "template_parts": parts,
        "template_looks": template_looks,
        "template_boxes": boxes,
        "template_pixels": random.integers(0, 255, (boxes[:, 2] * boxes[:, 3]).sum()).astype(
            np.uint8
        ),
        "example_scores": np.array(scores),
        "example_values": np.array(values),
        "footage": ["clip.mp4", "0" * 64],
        "example_frames": np.arange(1, 1 + len(values)),
    }
    return TaughtSet(**(fields | changes))
