# SPDX-License-Identifier: GPL-3.0-or-later
"""By how much relief and lines of a head shift its landmarks in its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic.fit.face_fit import FaceFit
from mimetic.template.face_template import FaceTemplate

Floats = NDArray[np.float64]


def picture_shifts(
    fit: FaceFit, template: FaceTemplate, poses: Sequence[Floats]
) -> list[dict[str, tuple[float, float]]]:
    """Pixels, right and down, by which relief and lines move each landmark; nothing without them.

    poses: 4 x 4, camera from head, one a picture
    """
    if not (fit.relief or fit.depth or fit.lines):
        return [{} for _ in poses]
    landmarks = np.asarray(template.landmark_vertices)
    plain_points, relief_points = (
        one.neutral_vertices(template)[landmarks]
        for one in (replace(fit, relief=[], depth=[], lines=[]), fit)
    )
    shifts = []
    for pose in poses:
        before, after = (fit.camera.pixels(one, pose) for one in (plain_points, relief_points))
        displacements = (after - before).tolist()
        shifts.append(
            {n: (x, y) for n, (x, y) in zip(template.landmark_names, displacements, strict=True)}
        )
    return shifts
