# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of any number of corners, as programs keep them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core


@dataclass(frozen=True)
class Polygons:
    """Faces of any number of corners: the first corner of each (P), and vertices of all corners."""

    starts: NDArray[np.int64]
    corners: NDArray[np.int64]

    def pieces(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """Triangles and quads F x 4 (a triangle ends in -1), and the polygon of each.

        points: V x 3; polygons of five and more are cut from their corner that leaves no sliver.
        """
        return _core.cut_polygons(points, self.starts, self.corners)
