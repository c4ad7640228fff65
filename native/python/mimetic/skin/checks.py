# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a head before muscles are attached to it: said by face, or repaired with a
warning."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mimetic import _core

EYES_APART = (0.03, 0.12)  # m between the centres of the eyes; adults have 0.054 to 0.074
UNITS = {
    "decimetres": 1e-1,
    "centimetres": 1e-2,
    "inches": 2.54e-2,
    "millimetres": 1e-3,
}
MAX_ROUNDS = 50


def check_size(neutral: NDArray[np.float64], template) -> None:
    """Raise InvalidInput unless the head (V x 3) is in metres, as its eyes tell."""
    centres, _ = template.eye_spheres(neutral)
    check_span(float(np.linalg.norm(centres[0] - centres[1])), "the eyes")


def check_span(apart: float, what: str) -> None:
    """Raise InvalidInput, naming the unit that it seems to be in, unless eyes are metres apart."""
    if EYES_APART[0] <= apart <= EYES_APART[1]:
        return
    typical = 0.063
    unit = min(UNITS, key=lambda name: abs(np.log(apart * UNITS[name] / typical + 1e-300)))
    advice = "scale it to the size of a head"
    if EYES_APART[0] <= apart * UNITS[unit] <= EYES_APART[1]:
        advice = f"if it is in {unit}, multiply its vertices by {UNITS[unit]:g}"
    raise _core.InvalidInput(
        f"{what} are {apart:.4g} m apart, expected are {EYES_APART[0]} to {EYES_APART[1]}: "
        f"the head is not in metres; {advice}"
    )


def check_areas(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32], parent_face: NDArray[np.int32]
) -> None:
    """Raise InvalidInput on a triangle without area, naming its face of the head.

    vertices N x 3 and triangles T x 3 of the refined skin; parent_face: T / 2, of the quads.
    """
    corners = vertices[triangles]
    sides = corners - np.roll(corners, 1, axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 1], sides[:, 2]), axis=1)
    empty = np.flatnonzero(~(doubled > 1e-9 * (sides**2).sum(2).max(1)))
    if len(empty):
        raise _core.InvalidInput(
            f"face {parent_face[empty[0] // 2]} of the head has no area: move its vertices apart"
        )


def unfold(
    vertices: NDArray[np.float64],
    split: Callable[[NDArray[np.float64]], NDArray[np.int32]],
    face: NDArray[np.integer],
) -> NDArray[np.float64]:
    """Vertices (N x 3) with no triangle turned over among those around it.

    Vertices of turned triangles go to the mean of their neighbours, and a warning names the faces
    of the head. split: the mesh's triangles for such vertices. Raises InvalidInput if that does not
    help. face: T, of the head, for each triangle.
    """
    triangles = split(vertices)
    turned = _core.inverted_faces(vertices, triangles)
    if not turned:
        return vertices
    found = set()
    repaired = vertices.copy()
    for _ in range(MAX_ROUNDS):
        found |= {int(face[triangle]) for triangle in turned}
        repaired = _to_mean_of_neighbours(repaired, triangles, np.unique(triangles[turned]))
        triangles = split(repaired)
        turned = _core.inverted_faces(repaired, triangles)
        if not turned:
            moved = 1e3 * np.linalg.norm(repaired - vertices, axis=1).max()
            warnings.warn(
                f"faces {_listed(sorted(found))} of the head lie turned over among those around "
                f"them; the skin was smoothed there, by up to {moved:.1f} mm",
                stacklevel=2,
            )
            return repaired
    raise _core.InvalidInput(
        f"face {face[turned[0]]} of the head lies turned over among those around it, "
        "and smoothing does not help: put its vertices back in their place"
    )


def _to_mean_of_neighbours(vertices, triangles, moved):
    sums, counts = np.zeros_like(vertices), np.zeros(len(vertices))
    for k in range(3):
        for other in (1, 2):
            np.add.at(sums, triangles[:, k], vertices[triangles[:, (k + other) % 3]])
            np.add.at(counts, triangles[:, k], 1)
    result = vertices.copy()
    result[moved] = sums[moved] / counts[moved, None]
    return result


def _listed(faces: list[int]) -> str:
    shown = ", ".join(str(face) for face in faces[:8])
    return shown if len(faces) <= 8 else f"{shown} and {len(faces) - 8} more"
