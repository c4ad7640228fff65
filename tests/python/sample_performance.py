# SPDX-License-Identifier: GPL-3.0-or-later
"""A small made-up performance: a curved patch that turns and bulges, seen by a 320 x 240 camera."""

import numpy as np
from mimetic.performance.document import Performance


def make_performance(num_frames=12, rings=9, **changes):
    rng = np.random.default_rng(5)
    x, y = np.meshgrid(np.linspace(-0.06, 0.06, rings), np.linspace(-0.08, 0.08, rings))
    vertices = np.stack([x, y, 0.08 - 4 * x**2 - 3 * y**2], axis=-1).reshape(-1, 3)
    corner = (np.arange(rings - 1)[:, None] * rings + np.arange(rings - 1)).reshape(-1)
    faces = np.stack([corner, corner + 1, corner + rings + 1, corner + rings], axis=1)
    phase = np.linspace(0, 1, num_frames)
    pose = np.tile(np.diag([1.0, -1, -1, 1]), (num_frames, 1, 1))
    yaw = 0.3 * np.sin(np.pi * phase)
    turn = np.tile(np.eye(3), (num_frames, 1, 1))
    turn[:, 0, 0] = turn[:, 2, 2] = np.cos(yaw)
    turn[:, 0, 2], turn[:, 2, 0] = np.sin(yaw), -np.sin(yaw)
    pose[:, :3, :3] = pose[:, :3, :3] @ turn
    pose[:, 2, 3] = 0.7
    sides = [f"muscle_{i:02d}.{side}" for i in range(18) for side in "LR"]
    values = {
        "frame": np.arange(1, num_frames + 1),
        "fps": 24000 / 1001,
        "image_size": np.array([320, 240]),
        "intrinsics": np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]),
        "head_pose": pose,
        "head_pose_cov": np.tile(np.diag([1e-5] * 3 + [1e-6] * 3), (num_frames, 1, 1)),
        "muscles": sides,
        "muscle_modes": rng.normal(0, 0.0004, (36, len(vertices), 3)),
        "groups": np.repeat(np.arange(1, 8), [8, 4, 4, 4, 6, 6, 4]),
        "activations": 0.5 + 0.5 * np.sin(phase[:, None] * 6 + np.arange(36)),
        "activations_std": np.full((num_frames, 36), 0.05),
        "articulators": ["jaw_open", "jaw_side"],
        "articulator_values": np.stack([phase, -phase], axis=1),
        "articulator_modes": rng.normal(0, 0.004, (2, len(vertices), 3)),
        "neutral_vertices": vertices,
        "faces": faces,
        "quality": np.linspace(1, 0.1, num_frames),
    }
    return Performance(**(values | changes))
