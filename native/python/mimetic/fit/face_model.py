# SPDX-License-Identifier: GPL-3.0-or-later
"""The template as the fit sees it: surface points, landmarks, curves and ways to differ."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_shape import face_shape
from mimetic.locate.landmarks import landmark_points
from mimetic.muscles.feature_lines import feature_lines
from mimetic.template.face_template import FaceTemplate

COMPONENT_LIMIT = 30.0  # prior standard deviations: a pin may be far off
OUTLINE_REGIONS = ("cheek", "zygomatic", "chin", "jaw_line", "temple")
CURVES = {
    "lip_line": ("mouth_corner.R", "lip_upper_inner", "mouth_corner.L"),
    "brow.L": ("brow_inner.L", "brow_middle.L", "brow_outer.L"),
    "brow.R": ("brow_outer.R", "brow_middle.R", "brow_inner.R"),
}
# Points between landmarks: weights sum to 1
BETWEEN = {
    "nostril.L": {"ala.L": 0.5, "nose_base": 0.35, "nose_tip": 0.15},
    "nostril.R": {"ala.R": 0.5, "nose_base": 0.35, "nose_tip": 0.15},
    "lip_line": {"lip_upper_inner": 0.5, "lip_lower_inner": 0.5},
}


@lru_cache(maxsize=6)
def face_model(
    template: FaceTemplate, with_identity: bool = True, with_residual: bool = True
) -> _core.FaceModel:
    """What the core's fit needs: points on the limit surface, then the two eyeballs' centres.

    Modes: the components of `face_shape` with the same arguments.
    """
    skin = template.num_skin_vertices
    on_limit = limit_positions(template)
    eyes = [template.part_vertices(name) for name in ("eye.L", "eye.R")]
    components = face_shape(template, with_identity, with_residual).components
    points = np.array(
        [
            np.vstack([on_limit(shape[:skin]), *(shape[eye].mean(axis=0) for eye in eyes)])
            for shape in (template.vertices, *components)
        ]
    )
    # Means of the eyeballs' vertices move as their centres do; the centres are the template's own
    points[0, skin:] = template.eye_centers
    return _model(template, points[0], points[1:])


def moved_model(
    template: FaceTemplate, neutral_vertices: NDArray[np.float64], modes: NDArray[np.float64]
) -> _core.FaceModel:
    """A person's head (V x 3) as the core's fit needs it, with other modes (M x V x 3) to move in.

    Each has a unit normal prior; the eyeballs stay.
    """
    skin = template.num_skin_vertices
    on_limit = limit_positions(template)
    eyes = [template.part_vertices(name) for name in ("eye.L", "eye.R")]
    moved = [(neutral_vertices - template.vertices)[eye].mean(axis=0) for eye in eyes]
    stay = np.zeros((2, 3))
    return _model(
        template,
        np.vstack([on_limit(neutral_vertices[:skin]), template.eye_centers + moved]),
        np.array([np.vstack([on_limit(mode[:skin]), stay]) for mode in modes]),
    )


def _model(
    template: FaceTemplate, points: NDArray[np.float64], modes: NDArray[np.float64]
) -> _core.FaceModel:
    """points: P x 3, the skin's, then the eyeballs' centres; modes: M x P x 3."""
    skin = template.num_skin_vertices
    faces = np.ascontiguousarray(template.skin_faces, dtype=np.int32)
    far = np.full((len(modes), 1), COMPONENT_LIMIT)
    names, weights = _landmark_weights(template, len(points))
    on_outline = np.zeros(len(points), dtype=bool)
    # Under the chin the outline runs on what counts as neck; the neck's own sides are not the jaw
    normals = _core.SubdividedMesh(faces, skin, 0).normals(
        np.ascontiguousarray(template.vertices[:skin])
    )[:skin]
    underside = template.in_region("neck") & (normals[:, 1] < -0.3)
    on_outline[:skin] = template.in_region(*OUTLINE_REGIONS) | underside
    chains = [
        _core.shortest_way(faces, points, [template.landmark(name) for name in stops])
        for stops in CURVES.values()
    ]
    lines = feature_lines(template)
    return _core.FaceModel(
        points,
        modes.reshape(len(modes), -1),
        np.ones(len(modes)),
        np.hstack([-far, far]),
        faces,
        on_outline.tolist(),
        names,
        weights,
        [*CURVES, *lines],
        [*chains, *lines.values()],
    )


def limit_positions(
    template: FaceTemplate,
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """A function from the skin's control vertices (S x 3) to their limits on the surface."""
    faces = np.ascontiguousarray(template.skin_faces, dtype=np.int32)
    num_vertices = template.num_skin_vertices
    surface = _core.SubdividedMesh(faces, num_vertices, 0)

    def apply(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface.positions(np.ascontiguousarray(vertices, dtype=np.float64))[:num_vertices]

    return apply


def _landmark_weights(
    template: FaceTemplate, num_points: int
) -> tuple[list[str], NDArray[np.float64]]:
    rows = {}
    for name, vertex in zip(template.landmark_names, template.landmark_vertices, strict=True):
        rows[name] = np.zeros(num_points)
        rows[name][vertex] = 1
    for name, parts in BETWEEN.items():
        rows[name] = np.sum([weight * rows[part] for part, weight in parts.items()], axis=0)
    for name, row in zip(*landmark_points(template), strict=True):
        rows.setdefault(name, row)
    return list(rows), np.array(list(rows.values()))
