# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as RGB and as graphics cards take them, and places in them as parts of the whole."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core


def as_rgb(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(H, W, 3) uint8, C order, from RGB, RGBA or grey; raises InvalidInput."""
    image = np.asarray(image)
    if image.dtype != np.uint8:
        raise InvalidInput(f"image is {image.dtype}; 8-bit pixels (uint8) are needed")
    if image.ndim == 3 and image.shape[2] == 1:
        image = image[:, :, 0]
    if image.ndim == 2:
        image = np.repeat(image[:, :, None], 3, axis=2)
    if image.ndim != 3 or image.shape[2] not in (3, 4):
        raise InvalidInput(
            f"image has shape {image.shape}; (height, width) or (height, width, 3) is needed"
        )
    return np.ascontiguousarray(image[:, :, :3])


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
