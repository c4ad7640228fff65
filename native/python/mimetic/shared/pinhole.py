# SPDX-License-Identifier: GPL-3.0-or-later
"""Pinhole cameras by their matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core

FULL_FRAME_MM = 36.0  # width of the sensor that focal lengths are usually told for


def is_pinhole(intrinsics: NDArray[np.float64]) -> bool:
    """Whether a 3 x 3 matrix is a camera's: focal lengths above 0, the last row 0 0 1."""
    return bool((np.diag(intrinsics) > 0).all() and np.allclose(intrinsics[2], [0, 0, 1]))


def camera_of(intrinsics: NDArray[np.float64], image_size: ArrayLike) -> _core.Camera:
    """A camera by its matrix (3 x 3) and its image's width and height, pixels."""
    width, height = (int(side) for side in np.asarray(image_size))
    (fx, _, cx), (_, fy, cy), _ = np.asarray(intrinsics, dtype=np.float64)
    return _core.Camera(fx, fy, cx, cy, width, height)
