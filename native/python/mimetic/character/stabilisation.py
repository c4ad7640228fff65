# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage with the head held still, so that only the face moves: which points hold it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.document import Performance


def anchors(performance: Performance) -> NDArray[np.float64]:
    """N x 2 x 2 pixels: the face's centre, and a point above it that goes with the head.

    Holding both still removes the head's translation in the picture, its roll and its scale.
    The second one's distance follows depth alone: a head that turns or nods is not zoomed.
    """
    height = float(performance.image_size[1])
    points = _core.still_points(performance.head_pose, performance.intrinsics, height)
    return points.reshape(-1, 2, 2)
