# SPDX-License-Identifier: GPL-3.0-or-later
"""How alike both halves of a canonical picture are: of a head fitted turned wrongly they differ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.shared.luminance import GREY

REACH = 12  # the surroundings that brightness is judged by: the picture's width over this
LEAST_CONTRAST = 2.0  # grey levels


def symmetry(picture: NDArray[np.uint8], seen: NDArray[np.bool_]) -> float:
    """Correlation of a canonical picture (S, S, 3) with its mirror image, -1 to 1.

    Brightness and contrast are taken out region by region: light comes from one side.
    """
    reach = len(picture) // REACH
    weight = seen.astype(float)
    cover = np.maximum(_box_mean(weight, reach), 1e-3)
    grey = picture @ GREY
    detail = (grey - _box_mean(grey * weight, reach) / cover) * weight
    contrast = np.sqrt(_box_mean(detail**2, reach) / cover) + LEAST_CONTRAST
    detail = _box_mean(detail / contrast, 1)
    both = seen & seen[:, ::-1]
    ours, mirrored = detail[both], detail[:, ::-1][both]
    return float(ours @ mirrored / np.sqrt((ours @ ours) * (mirrored @ mirrored) + 1e-12))


def _box_mean(values: NDArray[np.float64], reach: int) -> NDArray[np.float64]:
    """Mean over squares of 2 reach + 1 pixels; the border counts on."""
    for axis in (0, 1):
        width = [(reach + 1, reach) if a == axis else (0, 0) for a in (0, 1)]
        sums = np.cumsum(np.pad(values, width, mode="edge"), axis=axis)
        count, side = values.shape[axis], 2 * reach + 1
        values = np.take(sums, np.arange(side, side + count), axis)
        values = (values - np.take(sums, np.arange(count), axis)) / side
    return values
