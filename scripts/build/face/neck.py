# SPDX-License-Identifier: GPL-3.0-or-later
"""The neck under the head's texture island, cut level.

The island ends at the jaw, and no loop of the base mesh runs level round the neck. So the throat is
filled up first; then the columns of edges that run down from the border are followed to a cut plane
and divided evenly. Every new vertex lies on an edge of the base mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .topology import boundary_edges

# The cut plane in the base mesh, y = height + slope * z: above the collar bones, higher behind.
PLANE_HEIGHT = 5.96
PLANE_SLOPE = -0.16
RINGS = 5
DEEPEST_RING = 9
# A strip of faces across the throat, from under one ear to under the other, is shorter than this.
WIDEST_THROAT = 30


@dataclass(frozen=True)
class Neck:
    """New vertices in C columns and K rings; ring 0 is the island's border.

    `edge` (C,K,2) are base vertices, `weight` (C,K) that of the second one. `strips` (S,2) are the
    columns (from, to) beside each strip of faces, in the sense in which the head's faces run along
    the border; `uv` (S,K,2,2) the texture points on both sides of each strip.
    """

    edge: np.ndarray
    weight: np.ndarray
    strips: np.ndarray
    uv: np.ndarray


def cut_neck(
    vertices: np.ndarray, faces: np.ndarray, face_uv: np.ndarray, uv: np.ndarray, head: np.ndarray
) -> Neck:
    """Follow and divide the columns under the faces marked in `head` (F,) down to the cut plane."""
    border = boundary_edges(faces[head])
    below = _directed_lookup(faces)
    column_of = {int(a): i for i, (a, _) in enumerate(border)}
    divided: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    strips, strip_uv = [], []
    for start, end in border.tolist():
        sides, texture = _walk_down((start, end), faces, face_uv, below)
        positions = []
        for side in (0, 1):
            polyline = vertices[sides[:, side]]
            positions.append(_divide(polyline))
            divided[column_of[int(sides[0, side])]] = (sides[:, side], positions[-1])
        strips.append((column_of[start], column_of[end]))
        strip_uv.append([_sample(uv[texture[:, side]], positions[side]) for side in (0, 1)])
    edge, weight = [], []
    for column in range(len(border)):
        path, position = divided[column]
        segment = np.minimum(position.astype(int), len(path) - 2)
        edge.append(np.stack([path[segment], path[segment + 1]], axis=1))
        weight.append(position - segment)
    return Neck(
        np.array(edge), np.array(weight), np.array(strips), np.array(strip_uv).transpose(0, 2, 1, 3)
    )


def fill_throat(faces: np.ndarray, head: np.ndarray) -> np.ndarray:
    """`head` (F,) with the strips of faces that leave the head and return across the throat."""
    below = _directed_lookup(faces)
    filled = head.copy()
    for start, end in boundary_edges(faces[head]).tolist():
        strip: list[int] = []
        while len(strip) < WIDEST_THROAT:
            face, corner = below[end, start]
            if head[face]:
                filled[strip] = True
                break
            strip.append(face)
            start, end = np.roll(faces[face], -corner)[2:].tolist()
    return filled


def _directed_lookup(faces: np.ndarray) -> dict[tuple[int, int], tuple[int, int]]:
    """Directed edge -> (face, corner where it starts)."""
    return {
        (face[corner], face[(corner + 1) % 4]): (number, corner)
        for number, face in enumerate(faces.tolist())
        for corner in range(4)
    }


def _walk_down(
    border: tuple[int, int],
    faces: np.ndarray,
    face_uv: np.ndarray,
    below: dict[tuple[int, int], tuple[int, int]],
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and texture points (rings, 2) on both sides of the strip under a border edge."""
    start, end = border
    vertices, texture = [(start, end)], []
    for ring in range(DEEPEST_RING):
        face, corner = below[end, start]
        turned = np.roll(faces[face], -corner)
        turned_uv = np.roll(face_uv[face], -corner)
        if ring == 0:
            texture.append((turned_uv[1], turned_uv[0]))
        start, end = int(turned[2]), int(turned[3])
        vertices.append((start, end))
        texture.append((turned_uv[2], turned_uv[3]))
    return np.array(vertices), np.array(texture)


def _divide(polyline: np.ndarray) -> np.ndarray:
    """Positions (RINGS + 1,) along a polyline as vertex number + fraction, even to the cut."""
    height = polyline[:, 1] - PLANE_HEIGHT - PLANE_SLOPE * polyline[:, 2]
    last = int(np.argmax(height <= 0)) - 1
    if last < 0 or height[0] <= 0:
        raise ValueError("a column of the neck does not reach the cut plane")
    crossing = last + height[last] / (height[last] - height[last + 1])
    steps = np.linalg.norm(np.diff(polyline, axis=0), axis=1)
    length = np.concatenate([[0], np.cumsum(steps)])
    total = length[last] + (crossing - last) * steps[last]
    return np.interp(np.linspace(0, total, RINGS + 1), length, np.arange(len(polyline)))


def _sample(values: np.ndarray, position: np.ndarray) -> np.ndarray:
    index = np.arange(len(values))
    return np.stack([np.interp(position, index, column) for column in values.T], axis=1)
