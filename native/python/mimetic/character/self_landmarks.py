# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that place themselves on any head's mesh, by what networks see in pictures of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.character.foreign_face import Polygons, guess_landmarks
from mimetic.character.foreign_mesh import MAX_VERTICES, REQUIRED
from mimetic.locate.feature_networks import installed_networks
from mimetic.muscles.action_units import OFF_THE_FACE
from mimetic.shared.progress import Progress
from mimetic.template.face_template import FaceTemplate, load_template

SPREAD = 0.5  # of the identity modes' ranges, a standard deviation of people's
DOUBTFUL = 0.05  # interpupillary distances; landmarks less certain are named


@dataclass(frozen=True)
class SelfLandmarks:
    """places: by name, in the mesh's own frame and unit; doubts: standard deviations in
    interpupillary distances; guess: why they are a mere guess by the mesh's extent, or empty."""

    places: dict[str, NDArray[np.float64]]
    doubts: dict[str, float]
    guess: str = ""

    @property
    def doubtful(self) -> list[str]:
        """Names of those to look at."""
        return [name for name, doubt in self.doubts.items() if doubt > DOUBTFUL]


def find_on_object(
    points: ArrayLike,
    polygons: Polygons,
    metres_from_object: ArrayLike,
    progress: Progress | None = None,
) -> SelfLandmarks:
    """The needed landmarks of an object's mesh, in metres in the world; where no face is seen in
    it, a guess for a head that looks along -y with its top in z.

    points: V x 3, the object's frame; metres_from_object: 4 x 4; progress: False raises
    KeyboardInterrupt. Raises InvalidInput on a mesh without faces, or with too many vertices.
    """
    own = np.ascontiguousarray(points, np.float64)
    if len(own) > MAX_VERTICES:
        text = f"the mesh has {len(own)} vertices, at most are {MAX_VERTICES}"
        raise _core.InvalidInput(text)
    faces, _ = polygons.pieces(own)
    matrix = np.asarray(metres_from_object, np.float64)
    vertices, faces, _ = _core.place_mesh(own, faces, matrix)
    return find_landmarks(vertices, _core.cut_faces(vertices, faces)[0], progress)


def find_landmarks(
    vertices: ArrayLike, triangles: ArrayLike, progress: Progress | None = None
) -> SelfLandmarks:
    """The needed landmarks on a head that looks any way.

    vertices: V x 3, any unit and axes; triangles: T x 3, outward. Arguments, result and errors
    else as for `find_on_object`.
    """
    finder = _finder()
    vertices = np.ascontiguousarray(vertices, np.float64)
    if finder is None:
        return _guess(vertices, "the networks that see faces are not installed")
    stopped = []

    def goes_on(fraction: float) -> bool:
        if progress is None or progress(fraction, "looking at the face"):
            return True
        stopped.append(fraction)
        return False

    placed = finder.place(vertices, np.ascontiguousarray(triangles, np.int32), goes_on)
    if stopped:
        raise KeyboardInterrupt
    if placed is None:
        return _guess(vertices, "no face was seen in the mesh")
    return SelfLandmarks(
        dict(zip(REQUIRED, placed.places, strict=True)),
        dict(zip(REQUIRED, placed.sigma.tolist(), strict=True)),
    )


def _guess(vertices: NDArray[np.float64], reason: str) -> SelfLandmarks:
    return SelfLandmarks(guess_landmarks(vertices), dict.fromkeys(REQUIRED, math.inf), reason)


@lru_cache(maxsize=1)
def _finder() -> _core.LandmarkFinder | None:
    networks = installed_networks()
    if networks is None:
        return None
    template = load_template()
    triangles, _ = _core.cut_faces(template.vertices, template.faces.astype(np.int64))
    landmarks = [int(template.landmark(name)) for name in REQUIRED]
    return _core.LandmarkFinder(
        template.vertices, triangles, list(REQUIRED), landmarks, _people(template), networks
    )


def _people(template: FaceTemplate) -> _core.DeformableTemplate:
    modes = np.asarray(template.identity_modes, np.float64)
    limits = np.asarray(template.identity_limits, np.float64)
    quads = template.skin_faces
    is_face = np.zeros(len(template.vertices), bool)
    is_face[: int(template.num_skin_vertices)] = ~template.in_region(*OFF_THE_FACE)
    return _core.DeformableTemplate(
        template.vertices,
        np.ascontiguousarray(np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), np.int32),
        modes.reshape(len(modes), -1),
        SPREAD * (limits[:, 1] - limits[:, 0]) / 2,
        is_face.tolist(),
    )
