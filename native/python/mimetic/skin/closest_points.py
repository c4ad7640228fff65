# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest points of clouds and of triangles, with numpy alone and in little memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def nearest(points: NDArray[np.float64], among: NDArray[np.float64]) -> NDArray[np.int64]:
    """Index of the nearest of `among` for each point, a block at a time: memory stays small."""
    squared = (among**2).sum(axis=1)
    return np.concatenate(
        [
            np.argmin(squared - 2 * points[start : start + 256] @ among.T, axis=1)
            for start in range(0, len(points), 256)
        ]
    )


def triangles_around(triangles: NDArray[np.int32], num_vertices: int) -> NDArray[np.int64]:
    """N x K: triangles at each vertex, the last one repeated; zeros where there are none."""
    vertex = triangles.reshape(-1)
    order = np.argsort(vertex, kind="stable")
    counts = np.bincount(vertex, minlength=num_vertices)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    slot = np.minimum(np.arange(counts.max()), np.maximum(counts[:, None] - 1, 0))
    return np.where(
        counts[:, None] > 0, (order // 3)[np.minimum(starts[:, None] + slot, len(order) - 1)], 0
    )


def closest_weights(points: NDArray[np.float64], corners: NDArray[np.float64]):
    """Barycentric weights (... x 3) of the point of a triangle (... x 3 x 3) nearest to a point.

    The best of the point in its plane, if inside, and of the nearest on each of its three edges.
    """
    a, b, c = (corners[..., k, :] for k in range(3))
    inside = _plane_weights(points - a, b - a, c - a)
    choices = [np.where((inside >= 0).all(axis=-1, keepdims=True), inside, [1.0, 0.0, 0.0])]
    for start, end in ((0, 1), (1, 2), (2, 0)):
        edge = corners[..., end, :] - corners[..., start, :]
        along = ((points - corners[..., start, :]) * edge).sum(axis=-1)
        along = np.clip(along / np.maximum((edge**2).sum(axis=-1), 1e-18), 0, 1)
        weights = np.zeros(inside.shape)
        weights[..., start], weights[..., end] = 1 - along, along
        choices.append(weights)
    weights = np.stack(choices, axis=-2)
    places = np.einsum("...wk,...kx->...wx", weights, corners)
    gaps = np.linalg.norm(places - points[..., None, :], axis=-1)
    best = np.argmin(gaps, axis=-1)[..., None, None]
    return np.take_along_axis(weights, best, axis=-2)[..., 0, :]


def _plane_weights(arm, ab, ac):
    """Barycentric weights of a point's foot in a triangle's plane; arms from corner a."""
    aa, bb, cross = (ab**2).sum(-1), (ac**2).sum(-1), (ab * ac).sum(-1)
    ua, ub = (arm * ab).sum(-1), (arm * ac).sum(-1)
    scale = np.maximum(aa * bb - cross**2, 1e-30)
    v, w = (bb * ua - cross * ub) / scale, (aa * ub - cross * ua) / scale
    return np.stack([1 - v - w, v, w], axis=-1)
