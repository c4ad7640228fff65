# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of pictures and fields between their pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def sampled(field: NDArray, at: NDArray) -> NDArray:
    """Bilinear values (..., C) of a field (H,W,C) at pixels (..., 2), held at the border."""
    height, width = field.shape[:2]
    x = np.clip(at[..., 0], 0, width - 1)
    y = np.clip(at[..., 1], 0, height - 1)
    left = np.minimum(x.astype(int), width - 2)
    top = np.minimum(y.astype(int), height - 2)
    u, v = (x - left)[..., None], (y - top)[..., None]
    upper = (1 - u) * field[top, left] + u * field[top, left + 1]
    lower = (1 - u) * field[top + 1, left] + u * field[top + 1, left + 1]
    return ((1 - v) * upper + v * lower).astype(field.dtype)
