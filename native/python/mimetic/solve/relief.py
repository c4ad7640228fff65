# SPDX-License-Identifier: GPL-3.0-or-later
"""The depth of a face at each place, from frames in which the head is turned differently."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.depth_bumps import bump_places, depth_bumps
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_shape import face_shape
from mimetic.fit.views import spread_points
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

Floats = NDArray[np.float64]
LEAST_SIGHTINGS = 3
DEPTH_SPREAD = 0.005  # metres: prior s.d. of the depth that no component has


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
) -> FaceFit:
    """The fit with the relief that its head shows in several frames.

    sightings: of the fitted head, relief that it has already included; modes: M x S x 3 and std: M,
    prior, of the muscles and articulators with which it was followed. The fit as it is with too few
    frames, and when progress (a fraction -> go on?) says to stop.
    """
    if len(sightings) < LEAST_SIGHTINGS:
        return fit
    mesh = SkinMesh(template, np.ascontiguousarray(fit.neutral_vertices(template)))
    components = face_shape(template).components[:, : template.num_skin_vertices]
    bumps = DEPTH_SPREAD * depth_bumps(template)[:, : template.num_skin_vertices]
    skin = fitted_skin(mesh, fit.camera, fit.head_pose)
    places = bump_places(template)
    rays = skin.rays_to(places)
    relief = _core.find_relief(
        skin,
        np.ascontiguousarray(components),
        np.ascontiguousarray(bumps),
        np.ascontiguousarray(modes),
        std,
        template.landmark_vertices.tolist(),
        spread_points(template),
        places,
        _coefficients(fit, rays, len(components)),
        list(sightings),
        progress,
    )
    if len(relief.coefficients) == 0:
        return fit
    of_components, of_bumps = np.split(relief.coefficients, [len(components)])
    return replace(
        fit,
        relief=np.round(of_components, 6).tolist(),
        depth=np.round(DEPTH_SPREAD * of_bumps[:, None] * rays, 7).tolist(),
        depth_std=np.round(relief.depth_std, 6).tolist(),
    )


def _coefficients(fit: FaceFit, rays: Floats, num_components: int) -> Floats:
    """Those of components and bumps that the fit has."""
    of_components = np.array(fit.relief or np.zeros(num_components))
    depth = np.array(fit.depth or np.zeros(rays.shape))
    return np.append(of_components, (depth * rays).sum(1) / DEPTH_SPREAD)
