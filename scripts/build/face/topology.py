# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions to a quad mesh: rings around a set of vertices, edges, boundary loops."""

from __future__ import annotations

import numpy as np


def rings(faces: np.ndarray, seed: np.ndarray, num_vertices: int) -> np.ndarray:
    """Number of faces to cross from the `seed` vertices to each (V,); -1 where unreachable."""
    ring = np.full(num_vertices, -1)
    ring[seed] = 0
    distance = 0
    while True:
        touched = faces[(ring[faces] == distance).any(1)]
        fresh = np.unique(touched)[ring[np.unique(touched)] < 0]
        if len(fresh) == 0:
            return ring
        distance += 1
        ring[fresh] = distance


def directed_edges(faces: np.ndarray) -> np.ndarray:
    """(4F,2) edges in the sense of the faces' winding."""
    return np.stack([faces.ravel(), np.roll(faces, -1, axis=1).ravel()], axis=1)


def boundary_edges(faces: np.ndarray) -> np.ndarray:
    """Directed edges (B,2) that belong to one face only."""
    edges = directed_edges(faces)
    _, where, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    return edges[count[where.ravel()] == 1]


def components(faces: np.ndarray) -> np.ndarray:
    """Label per face: faces that share a vertex index have the same one."""
    label = np.arange(int(faces.max()) + 1)
    while True:
        lowest = label[faces].min(1)
        spread = label.copy()
        np.minimum.at(spread, faces.ravel(), np.repeat(lowest, faces.shape[1]))
        spread = spread[spread]
        if np.array_equal(spread, label):
            return label[faces[:, 0]]
        label = spread


def boundary_loops(faces: np.ndarray) -> list[np.ndarray]:
    """Closed loops of boundary vertices, each in walking order; the mesh must be a manifold."""
    after = {int(a): int(b) for a, b in boundary_edges(faces)}
    loops = []
    while after:
        loop = [next(iter(after))]
        while loop[-1] in after:
            loop.append(after.pop(loop[-1]))
        if loop[0] != loop[-1]:
            raise ValueError(f"boundary does not close at vertex {loop[-1]}")
        loops.append(np.array(loop[:-1]))
    return loops
