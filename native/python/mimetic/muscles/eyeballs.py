# SPDX-License-Identifier: GPL-3.0-or-later
"""The eyeballs of a head of the canonical mesh: where they are, which vertices turn with them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

SIDES = ("L", "R")


@dataclass(frozen=True)
class EyeGeometry:
    """Left first; metres, head frame."""

    centers: NDArray[np.float64]  # 2 x 3
    radii: NDArray[np.float64]  # 2, of the surface as it is seen
    eye_of_vertex: NDArray[np.int32]  # V, 0 none, 1 left, 2 right
    lid_per_degree: tuple[float, float]  # closure of the upper lids for a degree downwards

    def fronts(self) -> NDArray[np.float64]:
        """2 x 3: the middles of the irises of eyes that look straight ahead."""
        return self.centers + self.radii[:, None] * np.array([0.0, 0.0, 1.0])

    def fields(self, lid_following: Iterable[tuple[float, float]]) -> dict[str, Any]:
        """Keys of a performance for eyes that look straight ahead at gaze 0.

        lid_following: of each upper lid its closure for a degree down, and the fitted head's pitch.
        """
        return {
            "eye_centers": self.centers,
            "iris_centers": self.fronts(),
            "eye_of_vertex": self.eye_of_vertex.astype(np.int64),
            "lid_following": np.array(list(lid_following)),
        }


def eye_geometry(vertices: NDArray[np.float64], template: FaceTemplate) -> EyeGeometry:
    """Of a head at rest (V x 3) with the canonical mesh."""
    eye_of = np.zeros(len(vertices), dtype=np.int32)
    centers, radii = np.empty((2, 3)), np.empty(2)
    for eye, side in enumerate(SIDES):
        ball = template.part_vertices(f"eye.{side}")
        eye_of[ball] = 1 + eye
        centers[eye], radii[eye] = _core.nearest_sphere(limit_of(vertices, template, ball))
    left, right = (
        float(_core.lid_following(EyeLids(frame)))
        for frame in eye_frames(SkinMesh(template, np.ascontiguousarray(vertices)))
    )
    return EyeGeometry(centers, radii, eye_of, (left, right))


def limit_of(
    vertices: NDArray[np.float64], template: FaceTemplate, part_vertices: NDArray[np.int32]
) -> NDArray[np.float64]:
    """K x 3: where the limit surface has the control vertices (K) of a whole part."""
    faces = template.faces[np.isin(template.faces, part_vertices).all(axis=1)]
    indices, own = np.unique(faces, return_inverse=True)
    quads = np.ascontiguousarray(own.reshape(-1, 4), dtype=np.int32)
    mesh = _core.SubdividedMesh(quads, len(indices), 0)
    return mesh.positions(np.ascontiguousarray(vertices[indices]))[: len(indices)]
