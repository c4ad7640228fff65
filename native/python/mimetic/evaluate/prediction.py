# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a performance says that points of its first frame go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic._core import SubdividedMesh
from mimetic.performance import Performance

REFINEMENTS = 1


@dataclass(frozen=True)
class Followed:
    """N frames, K points."""

    tracks: NDArray[np.float64]  # N x K x 2, pixels
    points: NDArray[np.float64]  # N x K x 3, metres, the performance's head frame
    on_face: NDArray[np.bool_]  # K, whether the surface covers the point in the first frame


def follow(performance: Performance, pixels: NDArray[np.float64]) -> Followed:
    """Follows pixels (K,2) of the first frame on the nearest surface under them.

    A point that the surface does not cover moves as the nearest covered one does. Raises
    InvalidInput if it covers none.
    """
    mesh = SubdividedMesh(
        np.ascontiguousarray(performance.faces, np.int32),
        len(performance.neutral_vertices),
        REFINEMENTS,
    )
    triangles = mesh.faces[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    first = mesh.positions(performance.surface_in_camera(0))
    triangle, weights = _under(pixels, first, triangles, performance.intrinsics)
    on_face = triangle >= 0
    if not on_face.any():
        raise InvalidInput("the performance's face covers no point of the truth in the first frame")
    corners = triangles[triangle]
    tracks = np.empty((performance.num_frames, len(pixels), 2))
    points = np.empty((performance.num_frames, len(pixels), 3))
    for i in range(performance.num_frames):
        surface = mesh.positions(np.ascontiguousarray(performance.surface(i)))
        points[i] = np.einsum("kc,kcd->kd", weights, surface[corners])
        pose = performance.head_pose[i]
        tracks[i] = performance.project(points[i] @ pose[:3, :3].T + pose[:3, 3])
    nearest = _nearest(pixels, pixels[on_face])
    covered = tracks[:, on_face]
    tracks[:, ~on_face] = (pixels + (covered - covered[:1])[:, nearest])[:, ~on_face]
    return Followed(tracks, points, on_face)


def _under(
    pixels: NDArray, surface: NDArray, triangles: NDArray, intrinsics: NDArray
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Nearest triangle under each pixel, -1 for none (K,), and perspective-true weights (K,3)."""
    image = surface @ intrinsics.T
    image = image[:, :2] / image[:, 2:]
    corners = image[triangles]
    depths = surface[triangles, 2]
    low, high = corners.min(1), corners.max(1)
    found = np.full(len(pixels), -1)
    weights = np.zeros((len(pixels), 3))
    for k, pixel in enumerate(pixels):
        near = np.flatnonzero(((low <= pixel) & (pixel <= high)).all(1))
        shares = _barycentric(pixel, corners[near])
        inside = (shares >= -1e-9).all(1)
        near, shares = near[inside], shares[inside]
        if not len(near):
            continue
        inverse = shares / depths[near]
        hit = int(inverse.sum(1).argmax())
        found[k], weights[k] = near[hit], inverse[hit] / inverse[hit].sum()
    return found, weights


def _barycentric(pixel: NDArray, corners: NDArray) -> NDArray[np.float64]:
    """Weights (T,3) of a pixel in triangles (T,3,2) of the image; negative outside."""
    a, b, c = (corners[:, i] for i in range(3))
    double_area = _cross(b - a, c - a)
    double_area = np.where(np.abs(double_area) < 1e-12, np.nan, double_area)
    first = _cross(c - b, pixel - b) / double_area
    second = _cross(a - c, pixel - c) / double_area
    return np.nan_to_num(np.stack([first, second, 1 - first - second], 1), nan=-1.0)


def _cross(a: NDArray, b: NDArray) -> NDArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _nearest(pixels: NDArray, among: NDArray) -> NDArray[np.int64]:
    return np.linalg.norm(pixels[:, None] - among[None], axis=2).argmin(1)
