# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage with the head held still, so that only the face moves: which points hold it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.performance.document import Performance

CENTRE = np.array([0.0, -0.01, 0.085])  # metres, head frame: the bridge of a usual nose
ARM = 0.25  # picture heights: far enough from the centre for angles to be exact


def anchors(performance: Performance) -> NDArray[np.float64]:
    """N x 2 x 2 pixels: the face's centre, and a point above it that goes with the head.

    Holding both still takes out the head's way through the picture, its roll, and its nearing.
    The second one's distance follows depth alone: a head that turns or nods is not zoomed.
    """
    pose = performance.head_pose
    centre = pose[:, :3, :3] @ CENTRE + pose[:, :3, 3]
    above = centre + pose[:, :3, :3] @ np.array([0.0, 0.01, 0.0])
    at = performance.project(centre)
    upwards = performance.project(above) - at
    # A nod by a quarter turn hides where up is; no face is seen then
    upwards /= np.maximum(np.linalg.norm(upwards, axis=1, keepdims=True), 1e-9)
    reach = ARM * float(performance.image_size[1]) * np.median(centre[:, 2]) / centre[:, 2]
    return np.stack([at, at + reach[:, None] * upwards], axis=1)
