# SPDX-License-Identifier: GPL-3.0-or-later
"""The depth of a face at each place, from frames in which the head is turned differently."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_shape import face_shape
from mimetic.fit.views import spread_points
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

Floats = NDArray[np.float64]
LEAST_SIGHTINGS = 3


def fitted_skin(mesh: SkinMesh, camera: _core.Camera, head_pose: Floats) -> _core.FittedSkin:
    """The skin at rest, as sightings name its points. head_pose: 4 x 4, of the fitted frame."""
    neutral = np.ascontiguousarray(mesh.neutral[: int(mesh.template.num_skin_vertices)])
    return _core.FittedSkin(mesh.refinement, neutral, camera, head_pose)


def find_relief(
    fit: FaceFit,
    template: FaceTemplate,
    sightings: Sequence[_core.Sighting],
    modes: Floats,
    std: Floats,
    progress: Callable[[float], bool] | None = None,
) -> list[float]:
    """Coefficients of the components of `face_shape` by which the fitted head should differ.

    sightings: of the fitted head in several frames; modes: M x S x 3 and std: M, prior, of the
    muscles and articulators with which it was followed. Empty with too few frames, and when
    progress (a fraction -> go on?) says to stop.
    """
    if len(sightings) < LEAST_SIGHTINGS:
        return []
    mesh = SkinMesh(template, np.ascontiguousarray(fit.neutral_vertices(template)))
    relief = _core.find_relief(
        fitted_skin(mesh, fit.camera, fit.head_pose),
        np.ascontiguousarray(face_shape(template).components[:, : template.num_skin_vertices]),
        np.ascontiguousarray(modes),
        std,
        template.landmark_vertices.tolist(),
        spread_points(template),
        list(sightings),
        progress,
    )
    return np.round(relief, 6).tolist()
