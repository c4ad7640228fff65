# SPDX-License-Identifier: GPL-3.0-or-later
"""Places in pictures as parts of the whole; pictures as graphics cards take them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core


def picture_coordinates(pixels: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """Pixels (K x 2) as parts of the picture: 0 to 1 from edge to edge, from the bottom left."""
    parts = (np.asarray(pixels, dtype=np.float64) + 0.5) / np.asarray(image_size)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]])


def picture_pixels(coordinates: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """The inverse of `picture_coordinates`: K x 2."""
    parts = np.asarray(coordinates, dtype=np.float64).reshape(-1, 2)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]]) * np.asarray(image_size) - 0.5


def texels(image: NDArray[np.uint8], most_cols: int) -> NDArray[np.float32]:
    """A picture (H x W x 3) as graphics cards take it: h x w x 4, rows from the bottom up, red,
    green, blue and opacity from 0 to 1, w at most `most_cols`."""
    return _core.texels_of(np.ascontiguousarray(image), max(most_cols, 16))
