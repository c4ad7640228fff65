# SPDX-License-Identifier: GPL-3.0-or-later
"""Places in pictures: parts of the whole, and dense samples of quads laid on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_STEPS = 96  # samples along a quad's side


@dataclass(frozen=True)
class Samples:
    """A dense, even grid of points on quads: K points."""

    face: NDArray[np.int64]  # K
    corner_weights: NDArray[np.float32]  # K x 4, bilinear

    def of(self, corners: NDArray) -> NDArray:
        """Interpolates F x 4 x C values at a quad's corners: K x C."""
        weights = self.corner_weights
        return sum(weights[:, c, None] * corners[self.face, c] for c in range(4))


def picture_coordinates(pixels: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """Pixels (K x 2) as parts of the picture: 0 to 1 from edge to edge, from the bottom left."""
    parts = (np.asarray(pixels, dtype=np.float64) + 0.5) / np.asarray(image_size)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]])


def picture_pixels(coordinates: ArrayLike, image_size: ArrayLike) -> NDArray[np.float64]:
    """The inverse of `picture_coordinates`: K x 2."""
    parts = np.asarray(coordinates, dtype=np.float64).reshape(-1, 2)
    return np.column_stack([parts[:, 0], 1 - parts[:, 1]]) * np.asarray(image_size) - 0.5


def sample_quads(texels: NDArray, faces: NDArray) -> Samples:
    """Points close enough that every texel of the quads is met.

    texels: F x 4 x 2 corners in texels; faces: F, what the points are to call these quads.
    """
    sides = np.linalg.norm(np.roll(texels, -1, axis=1) - texels, axis=2).max(axis=1)
    steps = np.clip(2 ** np.ceil(np.log2(sides * 1.5 + 1)), 2, MOST_STEPS).astype(int)
    owners, weights = [], []
    for count in np.unique(steps):
        t = (np.arange(count, dtype=np.float32) + 0.5) / count
        s, t = (grid.reshape(-1) for grid in np.meshgrid(t, t))
        grid = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
        of_count = faces[steps == count]
        owners.append(np.repeat(of_count, len(grid)))
        weights.append(np.tile(grid, (len(of_count), 1)))
    return Samples(np.concatenate(owners), np.concatenate(weights))
