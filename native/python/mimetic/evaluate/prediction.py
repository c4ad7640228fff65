# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a performance says that points of its first frame go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.performance import Performance
from mimetic.points import RefinedSurface, find_places

TILE_PX = 16.0


@dataclass(frozen=True)
class Followed:
    """N frames, K points."""

    tracks: NDArray[np.float64]  # N x K x 2, pixels
    points: NDArray[np.float64]  # N x K x 3, metres, the performance's head frame; nan off the face
    on_face: NDArray[np.bool_]  # K, whether the surface covers the point in the first frame


def follow(performance: Performance, pixels: NDArray[np.float64]) -> Followed:
    """Follows pixels (K,2) of the first frame on the nearest surface under them.

    A point that the surface does not cover moves as the nearest covered one does. Raises
    InvalidInput if it covers none.
    """
    surface = RefinedSurface(performance)
    triangle, weights = places_under(performance, pixels, surface)
    on_face = triangle >= 0
    if not on_face.any():
        raise InvalidInput("the performance's face covers no point of the truth in the first frame")
    corners = surface.triangles[triangle]
    tracks = np.empty((performance.num_frames, len(pixels), 2))
    points = np.full((performance.num_frames, len(pixels), 3), np.nan)
    for i in range(performance.num_frames):
        pose = performance.head_pose[i]
        placed = np.einsum("kc,kcx->kx", weights, surface.in_camera(i)[corners])[on_face]
        tracks[i, on_face] = performance.project(placed)
        points[i, on_face] = (placed - pose[:3, 3]) @ pose[:3, :3]
    nearest = _nearest(pixels, pixels[on_face])
    covered = tracks[:, on_face]
    tracks[:, ~on_face] = (pixels + (covered - covered[:1])[:, nearest])[:, ~on_face]
    return Followed(tracks, points, on_face)


def places_under(
    performance: Performance, pixels: NDArray[np.float64], surface: RefinedSurface
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """`points.find_places` in the first frame, asked tile by tile: ten times faster for many."""
    vertices = surface.in_camera(0)
    shown = performance.project(vertices)[surface.triangles]
    low, high = shown.min(1), shown.max(1)
    found = np.full(len(pixels), -1)
    weights = np.zeros((len(pixels), 3))
    tiles = np.floor(pixels / TILE_PX)
    for tile in np.unique(tiles, axis=0):
        here = np.flatnonzero((tiles == tile).all(1))
        near = (high >= TILE_PX * tile) & (low <= TILE_PX * (tile + 1))
        chosen = np.flatnonzero(near.all(1))
        if len(chosen) == 0:
            continue
        triangles = surface.triangles[chosen]
        at, weights[here] = find_places(performance, pixels[here], vertices, triangles)
        found[here] = np.where(at >= 0, chosen[at], -1)
    return found, weights


def _nearest(pixels: NDArray, among: NDArray) -> NDArray[np.int64]:
    return np.linalg.norm(pixels[:, None] - among[None], axis=2).argmin(1)
