# SPDX-License-Identifier: GPL-3.0-or-later
"""One shape of a character with its curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Shape:
    """One shape: V control vertices, N frames."""

    name: str
    group: str  # what curves are listed under
    offsets: NDArray[np.float64]  # V x 3, metres in the head frame at value 1
    values: NDArray[np.float64]  # N; none for a slider without a curve
    lowest: float  # range of the values' slider; every value lies inside
    highest: float


def shape_of_values(
    name: str,
    group: str,
    offsets: NDArray,
    values: NDArray[np.float64],
    lowest: float,
    highest: float = 1.0,
) -> Shape:
    """A shape whose slider reaches from lowest to highest, and as far as its values (N)."""
    return Shape(
        name,
        group,
        np.asarray(offsets, dtype=np.float64),
        values,
        min(lowest, float(values.min())),
        max(highest, float(values.max())),
    )
