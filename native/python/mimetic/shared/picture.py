# SPDX-License-Identifier: GPL-3.0-or-later
"""Places in pictures as parts of the whole."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def picture_coordinates(pixels: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """Pixels (K x 2) as parts of the picture: 0 to 1 from edge to edge, from the bottom left."""
    parts = (np.asarray(pixels, dtype=np.float64) + 0.5) / np.asarray(image_size)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]])


def picture_pixels(coordinates: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """The inverse of `picture_coordinates`: K x 2."""
    parts = np.asarray(coordinates, dtype=np.float64).reshape(-1, 2)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]]) * np.asarray(image_size) - 0.5
