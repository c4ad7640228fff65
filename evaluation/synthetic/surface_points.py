# SPDX-License-Identifier: GPL-3.0-or-later
"""Held-out points of the drawn surface: where they are in every frame, and whether seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# A point counts as seen if nothing lies more than this before it at its pixel, and as faced if
# the surface there is turned to the camera by this cosine at least.
DEPTH_TOLERANCE = 0.004
LEAST_COSINE = 0.2
LEAST_COSINE_AT_START = 0.35
CELLS_PER_PIXEL = 0.8


@dataclass(frozen=True)
class SurfacePoints:
    """Points on the drawn surface: vertices of each one's triangle (K,3), weights (K,3)."""

    corners: np.ndarray
    weights: np.ndarray

    def positions(self, surface: np.ndarray) -> np.ndarray:
        """(K,3) on a surface's vertices (R,3)."""
        return np.einsum("kc,kcd->kd", self.weights, surface[self.corners])

    def normals(self, surface: np.ndarray) -> np.ndarray:
        a, b, c = (surface[self.corners[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def in_camera(surface: np.ndarray, camera_from_head: np.ndarray) -> np.ndarray:
    return surface @ camera_from_head[:3, :3].T + camera_from_head[:3, 3]


def project(points_in_camera: np.ndarray, intrinsics: np.ndarray) -> np.ndarray:
    """Pixels (K,2); (0, 0) is the centre of the top-left one."""
    pixels = points_in_camera @ intrinsics.T
    return pixels[:, :2] / pixels[:, 2:]


def choose(
    surface: np.ndarray,
    quads: np.ndarray,
    allowed: np.ndarray,
    camera_from_head: np.ndarray,
    intrinsics: np.ndarray,
    number: int,
    seed: int,
) -> SurfacePoints:
    """Random points, even by area, on the allowed quads (Q, bool) that are seen in this frame."""
    rng = np.random.default_rng([seed, 51])
    chosen = quads[allowed]
    triangles = np.concatenate([chosen[:, [0, 1, 2]], chosen[:, [0, 2, 3]]])
    a, b, c = (surface[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = triangles[rng.choice(len(triangles), 20 * number, p=area / area.sum())]
    s, t = np.sqrt(rng.random(len(drawn))), rng.random(len(drawn))
    points = SurfacePoints(drawn, np.column_stack([1 - s, s * (1 - t), s * t]))
    seen = visible(points, surface, quads, camera_from_head, intrinsics, LEAST_COSINE_AT_START)
    first = np.flatnonzero(seen)[:number]
    if len(first) < number:
        raise ValueError(f"only {len(first)} of {number} points are visible in the first frame")
    return SurfacePoints(points.corners[first], points.weights[first])


def visible(
    points: SurfacePoints,
    surface: np.ndarray,
    quads: np.ndarray,
    camera_from_head: np.ndarray,
    intrinsics: np.ndarray,
    least_cosine: float = LEAST_COSINE,
) -> np.ndarray:
    """Which points (K,) the camera sees; `surface` (R,3) in the head frame."""
    placed = in_camera(surface, camera_from_head)
    at = points.positions(placed)
    toward = -at / np.linalg.norm(at, axis=1, keepdims=True)
    faced = (points.normals(placed) * toward).sum(1) > least_cosine
    nearest, origin = _depth_map(placed, quads, intrinsics)
    cell = np.floor(project(at, intrinsics) * CELLS_PER_PIXEL).astype(int) - origin
    cell = np.clip(cell, 0, np.array(nearest.shape) - 1)
    return faced & (at[:, 2] < nearest[cell[:, 0], cell[:, 1]] + DEPTH_TOLERANCE)


def _depth_map(placed: np.ndarray, quads: np.ndarray, intrinsics: np.ndarray):
    """Least depth of the surface by cell of the image, from vertices and points between them."""
    corners = placed[quads]
    middles = [(corners[:, i] + corners[:, j]) / 2 for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    samples = np.concatenate([placed, corners.mean(1), *middles])
    cells = np.floor(project(samples, intrinsics) * CELLS_PER_PIXEL).astype(int)
    origin = cells.min(0)
    cells -= origin
    nearest = np.full(cells.max(0) + 1, np.inf)
    np.minimum.at(nearest, (cells[:, 0], cells[:, 1]), samples[:, 2])
    return nearest, origin
