# SPDX-License-Identifier: GPL-3.0-or-later
"""Teeth that are where the base mesh has them also when they are shown, and near the lips.

The base mesh's teeth are few large faces: subdivided, as they are shown, they shrink by 3 mm, and a
clenched jaw showed the tongue between its rows. They also lie 6 mm behind the lips, and end a
millimetre above the upper lip's edge, where a person's end 2 to 3 mm below it [Vig and Brundo
1978]: opened mouths showed none.
"""

from __future__ import annotations

import numpy as np

from .head import Cut

INTERPOLATED = ("teeth_upper", "teeth_lower")
# Metres: half of the way down, for people vary; forwards as far as lips stay 3 mm before them in
# every expression (tests/python/muscles/test_contact.py). The rows overlap by a millimetre then.
SHIFTS = {
    "teeth_upper": (0.0, -0.0018, 0.0005),
    "teeth_lower": (0.0, -0.0002, 0.0005),
    "tongue": (0.0, -0.0002, 0.0005),
}


def with_teeth_near_lips(vertices: np.ndarray, cut: Cut) -> np.ndarray:
    """Positions (V, 3), metres, of the head's own."""
    moved = vertices.copy()
    for name, shift in SHIFTS.items():
        moved[cut.part_vertices(name)] += shift
    return moved


def through_base_mesh(field: np.ndarray, cut: Cut) -> np.ndarray:
    """Positions or displacements (..., V, 3) whose limit is what is given, at the teeth.

    Limits are means of control vertices, so what moves the part rigidly still does.
    """
    result = field.copy()
    for name in INTERPOLATED:
        vertices = cut.part_vertices(name)
        faces = np.searchsorted(vertices, cut.faces[np.isin(cut.faces, vertices).all(axis=1)])
        result[..., vertices, :] = np.linalg.solve(
            limit_weights(faces, len(vertices)), field[..., vertices, :]
        )
    return result


def limit_weights(faces: np.ndarray, count: int) -> np.ndarray:
    """count x count: the Catmull-Clark limit of each vertex of quads (F,4) by all of them.

    Inside, (n^2 v + 4 sum of edges' ends + sum of faces' far corners) / (n (n + 5)) at valence n;
    at a boundary a sixth of each neighbour along it and two thirds of the vertex [Halstead, Kass
    and DeRose 1993].
    """
    edges: dict[tuple[int, int], int] = {}
    near = np.zeros((count, count))
    far = np.zeros((count, count))
    for face in faces.tolist():
        for k, vertex in enumerate(face):
            following = face[(k + 1) % 4]
            edge = min(vertex, following), max(vertex, following)
            edges[edge] = edges.get(edge, 0) + 1
            far[vertex, face[(k + 2) % 4]] += 1
    border = np.zeros((count, count))
    for (one, other), sides in edges.items():
        near[[one, other], [other, one]] = 1
        if sides == 1:
            border[[one, other], [other, one]] = 1
    weights = np.zeros((count, count))
    for vertex in range(count):
        if border[vertex].any():
            weights[vertex] = border[vertex] / 6
            weights[vertex, vertex] += 2 / 3
        else:
            n = near[vertex].sum()
            weights[vertex] = (4 * near[vertex] + far[vertex]) / (n * (n + 5))
            weights[vertex, vertex] += n / (n + 5)
    return weights
