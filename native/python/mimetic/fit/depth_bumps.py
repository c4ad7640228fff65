# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth bumps all over the face: the depth of a person that no usual proportions have."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.residual_shape import with_parts
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE

RADIUS = 0.016  # metres, s.d. of a bump
PLACES = 90  # of bumps
LEAST_WEIGHT = 1e-9  # where no bump reaches, all count alike


@lru_cache(maxsize=2)
def bump_places(template: FaceTemplate) -> list[int]:
    """The skin vertices (K) in whose middle the bumps are, well apart over the face."""
    points = template.vertices[: template.num_skin_vertices]
    is_allowed = template.in_region(*FACE).tolist()
    return _core.spread_rows(points, [template.landmark("nose_tip")], is_allowed, PLACES)


@lru_cache(maxsize=2)
def depth_bumps(template: FaceTemplate) -> NDArray[np.float64]:
    """Heights K x V; where bumps lie densest, independent ones of unit variance sum up to such."""
    points = np.ascontiguousarray(template.vertices[: template.num_skin_vertices])
    heights = _core.bumps(points, bump_places(template), RADIUS)
    return with_parts(template, heights[..., None])[..., 0]


def between_bumps(template: FaceTemplate, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the bumps' places have (K) at all skin vertices (S): the mean, by the bumps' heights.

    Raises InvalidInput.
    """
    heights = np.abs(depth_bumps(template)[:, : template.num_skin_vertices])
    if len(values) != len(heights):
        raise InvalidInput(
            f"face fit has {len(values)} depth_std, this head has {len(heights)} bumps: fit again"
        )
    weights = heights + LEAST_WEIGHT
    return values @ weights / weights.sum(0)
