# SPDX-License-Identifier: GPL-3.0-or-later
"""Glasses that a person wears: their rims turn with the head and hide how the skin moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.template.face_template import FaceTemplate


def rims_before(
    image: NDArray[np.uint8], fit: FaceFit, template: FaceTemplate
) -> list[NDArray[np.float64]]:
    """The rims in front of the face in its fit's frame; none where it wears no glasses.

    image: (H, W, 3) uint8, the footage's frame number `fit.frame`. Returns curves, N x 3 each, head
    frame, metres (`_core.glasses_rims`).
    """
    eyes, _ = template.eye_spheres(fit.neutral_vertices(template))
    pose = np.asarray(fit.head_pose, dtype=np.float64)
    return _core.glasses_rims(np.ascontiguousarray(image), fit.camera, pose, eyes)


def notes_on_glasses(image: NDArray[np.uint8], fit: FaceFit, template: FaceTemplate) -> list[str]:
    """A note where it wears some; as `rims_before`."""
    notes = []
    if rims_before(image, fit, template):
        notes.append(
            "the face wears glasses: no skin is followed behind their rims, and what moves the "
            "lids and the cheeks below is less sure"
        )
    return notes
