# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a head before muscles are attached to it: said by face, or repaired with a
warning."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.template.face_template import FaceTemplate

EYES_APART = (0.03, 0.12)  # m between the centres of the eyes; adults have 0.054 to 0.074
UNITS = {
    "decimetres": 1e-1,
    "centimetres": 1e-2,
    "inches": 2.54e-2,
    "millimetres": 1e-3,
}


def check_size(neutral: NDArray[np.float64], template: FaceTemplate) -> None:
    """Raise InvalidInput unless the head (V x 3) is in metres, by the distance of its eyes."""
    (left, right), _ = template.eye_spheres(neutral)
    check_span(math.dist(left, right), "the eyes")


def check_span(apart: float, what: str) -> None:
    """Raise InvalidInput, naming the unit that it seems to be in, unless eyes are metres apart."""
    if EYES_APART[0] <= apart <= EYES_APART[1]:
        return
    unit = min(
        UNITS, key=lambda name: abs(np.log(apart * UNITS[name] / _core.PUPIL_DISTANCE + 1e-300))
    )
    advice = "scale it to the size of a head"
    if EYES_APART[0] <= apart * UNITS[unit] <= EYES_APART[1]:
        advice = f"if it is in {unit}, multiply its vertices by {UNITS[unit]:g}"
    raise _core.InvalidInput(
        f"{what} are {apart:.4g} m apart, expected are {EYES_APART[0]} to {EYES_APART[1]}: "
        f"the head is not in metres; {advice}"
    )


def unfold(
    vertices: NDArray[np.float64],
    split: Callable[[NDArray[np.float64]], NDArray[np.int32]],
    face: NDArray[np.int32],
) -> NDArray[np.float64]:
    """Vertices (N x 3) with no triangle turned over among those around it.

    Vertices of turned triangles go to the mean of their neighbours, and a warning names the faces
    of the head. split: the mesh's triangles for such vertices. Raises InvalidInput if that does not
    help. face: T, of the head, for each triangle.
    """
    new_vertices, faces, farthest = _core.unfold(vertices, split, face)
    warn_of_smoothed(faces, farthest)
    return new_vertices


def warn_of_smoothed(faces: Sequence[int], farthest: float) -> None:
    """Warn of faces that lay turned over, if there were any; farthest: m, a vertex was moved."""
    if faces:
        warnings.warn(
            f"faces {_listed(faces)} of the head lie turned over among those around "
            f"them; the skin was smoothed there, by up to {1e3 * farthest:.1f} mm",
            stacklevel=3,
        )


def _listed(faces: Sequence[int]) -> str:
    text = ", ".join(str(face) for face in faces[:8])
    return text if len(faces) <= 8 else f"{text} and {len(faces) - 8} more"
