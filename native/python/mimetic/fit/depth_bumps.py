# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth bumps all over the face: the depth of a person that no usual proportions have."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.residual_shape import with_parts
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE

RADIUS = 0.016  # metres, s.d. of a bump
PLACES = 90  # of bumps


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
