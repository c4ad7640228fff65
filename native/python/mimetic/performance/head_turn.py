# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's turn from facing the camera, as receivers want it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core

# A head that faces the camera: camera from head
FACING = np.diag([1.0, -1.0, -1.0])


def head_turn(head_pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """3 x 3 about x to the subject's left, y up, z to the camera; identity facing it.

    head_pose: 4 x 4, camera from head.
    """
    return np.ascontiguousarray(FACING @ head_pose[:3, :3])


def quaternion(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """(w, x, y, z) of a rotation (3 x 3)."""
    return _core.quaternions(turn[None])[0]


def angles(turn: NDArray[np.float64]) -> tuple[float, float, float]:
    """Yaw, pitch, roll in radians, about y, then x, then z: positive to the left, down, ear up.

    The ear is the subject's left one: as ARKit has the angles.
    """
    pitch, yaw, roll = _core.euler_angles(turn[None], "ZXY")[0]
    return float(yaw), float(pitch), float(roll)
