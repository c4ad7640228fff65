# SPDX-License-Identifier: GPL-3.0-or-later
"""Places of the skin that corrections name, on the surface of any frame; and which one a pixel
shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.corrections import SkinPin
from mimetic.performance.places import RefinedSurface
from mimetic.template.face_template import FaceTemplate

# (s, t) of a quad's corners, as `LimitSurface` has them
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


class PinnedPlaces:
    """Places of pins on the limit surface of the skin; linear in the control vertices."""

    def __init__(self, template: FaceTemplate, pins: Sequence[SkinPin]) -> None:
        st = np.clip(np.array([pin.weights for pin in pins]) @ CORNERS, 0, 1)
        faces = np.array([pin.face for pin in pins], dtype=np.int32)
        self._num_vertices = template.num_skin_vertices
        self._limit = _core.LimitSurface(
            np.ascontiguousarray(template.skin_faces, dtype=np.int32),
            self._num_vertices,
            faces,
            np.ascontiguousarray(st),
        )

    def positions(self, vertices: NDArray[np.floating]) -> NDArray[np.float64]:
        """P x 3, of the head's control vertices (V x 3), or of displacements of them."""
        skin = vertices[: self._num_vertices]
        return self._limit.positions(np.ascontiguousarray(skin, dtype=np.float64))


def place_under(
    surface: RefinedSurface, pixel: tuple[float, float], frame_index: int
) -> tuple[int, tuple[float, float, float, float]] | None:
    """Face and weights of its corners of the skin that a pixel shows in a frame; None beside it."""
    pixels = np.array([pixel], dtype=np.float64)
    vertices = surface.in_camera(frame_index)
    triangles, weights = _core.cast_rays(surface.camera, vertices, surface.triangles, pixels)
    if triangles[0] < 0:
        return None
    face, (s, t) = surface.mesh.place_of(int(triangles[0]), weights[0])
    corners = ((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t)
    return int(surface.kept_faces[face]), (corners[0], corners[1], corners[2], corners[3])
