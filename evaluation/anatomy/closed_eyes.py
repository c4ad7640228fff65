# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be seen of eyeballs behind lids that are shut."""

from __future__ import annotations

import numpy as np
from mimetic import _core
from numpy.typing import NDArray

VIEWS = ((0.0, 0.0), (0.6, 0.0), (-0.6, 0.0), (0.0, 0.4), (0.0, -0.4))  # radians to a side, up
DISTANCE = 0.6  # m of the camera
PIXEL = 1.5e-4  # m at the eye
REACH = 0.025  # m about the eye's middle
# An eyeball's top, 30 degrees and more above its middle: seen from above, over the edge
# of a face that ends at the brows, it is no opening of lids
TOP = 0.5


def seen_area(
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int32],
    is_eyeball: NDArray[np.bool_],
    centre: NDArray[np.float64],
) -> float:
    """mm^2 of an eyeball, its top left out, in the view in which most of it is seen.

    vertices: V x 3, metres, head frame; triangles: those of skin and eyeballs; is_eyeball: V;
    centre: of the eye.
    """
    size = int(2 * REACH / PIXEL)
    camera = _core.Camera(DISTANCE / PIXEL, DISTANCE / PIXEL, size / 2, size / 2, size, size)
    rows, columns = np.mgrid[:size, :size]
    pixels = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(np.float64)
    outwards = vertices[triangles].mean(axis=1) - centre
    is_top = outwards[:, 1] > TOP * np.sqrt((outwards**2).sum(axis=1))
    is_counted = is_eyeball[triangles[:, 0]] & ~is_top
    areas = []
    for yaw, pitch in VIEWS:
        turned = (vertices - centre) @ (_about(1, yaw) @ _about(0, pitch)).T
        placed = np.ascontiguousarray(turned * [1, -1, -1] + [0, 0, DISTANCE])
        hit, _ = _core.cast_rays(camera, placed, triangles, pixels)
        is_seen = (hit >= 0) & is_counted[hit]
        areas.append(1e6 * PIXEL**2 * int(is_seen.sum()))
    return max(areas)


def _about(axis: int, angle: float) -> NDArray[np.float64]:
    """3 x 3, a turn about x (0) or y (1)."""
    turn = np.eye(3)
    others = [k for k in range(3) if k != axis]
    cos, sin = np.cos(angle), np.sin(angle)
    turn[np.ix_(others, others)] = [[cos, -sin], [sin, cos]]
    return turn
