# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pinhole camera shows of points on the head, and how that changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def project_points(
    points: Floats, camera_from_head: Floats, intrinsics: Floats
) -> tuple[Floats, Floats, Floats]:
    """Pixels K x 2, their derivatives by the points (K x 2 x 3) and by a step of the pose.

    points: K x 3, metres, head frame; camera_from_head: 4 x 4; intrinsics: 3 x 3, pixels. The step
    (K x 2 x 6) is a rotation vector about the head's origin, then a shift, both in camera axes.
    """
    rotation = camera_from_head[:3, :3]
    offsets = points @ rotation.T
    x, y, z = (offsets + camera_from_head[:3, 3]).T
    fx, fy = intrinsics[0, 0], intrinsics[1, 1]
    pixels = np.stack([fx * x / z, fy * y / z], axis=1) + intrinsics[:2, 2]
    by_place = np.zeros((len(points), 2, 3))
    by_place[:, 0, 0], by_place[:, 1, 1] = fx / z, fy / z
    by_place[:, 0, 2], by_place[:, 1, 2] = -fx * x / z**2, -fy * y / z**2
    turning = np.cross(np.eye(3), offsets[:, None]).transpose(0, 2, 1)
    by_pose = np.concatenate([by_place @ turning, by_place], axis=2)
    return pixels, by_place @ rotation, by_pose
