# SPDX-License-Identifier: GPL-3.0-or-later
"""Strain of a face's skin from rest to another shape, as colours and as numbers.

Strain is of the limit surface that is seen: by `_core.StrainMeter`, of area or of the largest and
the smallest length, each less 1. Metres, head frame.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.skin.mesh import SkinMesh

MEASURES = {"area": 0, "stretch": 1, "compression": 2}  # columns of StrainMeter.at_vertices
SHORTER, AT_REST, LONGER = (0.13, 0.33, 0.90), (0.93, 0.93, 0.90), (0.87, 0.10, 0.10)
LIFT = 0.0006  # over the skin, which would shine through; below the muscles
FAINTEST, STRONGEST = 0.15, 0.9  # opacity at rest and at the scale's end


class StrainMap:
    """Strain on the outer skin of a neutral head, at the N vertices of its refined mesh."""

    def __init__(self, mesh: SkinMesh):
        self._mesh = mesh

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """T x 3 of the outer skin."""
        outer = self._mesh.triangle_part == "skin"
        return np.ascontiguousarray(self._mesh.triangles[outer], dtype=np.int32)

    @cached_property
    def _meter(self) -> _core.StrainMeter:
        return _core.StrainMeter(self._mesh.vertices, self.triangles)

    def measure(self, refined_vertices: NDArray[np.float64], measure: str) -> NDArray[np.float64]:
        """N strains of a shape of the refined skin (N x 3): area, stretch or compression."""
        if measure not in MEASURES:
            raise _core.InvalidInput(
                f"there is no strain {measure!r}; there are {', '.join(MEASURES)}"
            )
        return self._meter.at_vertices(refined_vertices)[:, MEASURES[measure]]


def strain_colours(strain: NDArray[np.float64], limit: float) -> NDArray[np.float32]:
    """Colours (... x 4, sRGB and opacity) from blue at -limit over nearly clear to red at limit."""
    if not limit > 0:
        raise _core.InvalidInput(f"the strain's limit is {limit}, needed is a number over 0")
    share = np.clip(np.asarray(strain) / limit, -1, 1)[..., None]
    ends = np.where(share < 0, SHORTER, LONGER)
    colours = np.empty((*share.shape[:-1], 4), dtype=np.float32)
    colours[..., :3] = AT_REST + np.abs(share) * (ends - np.array(AT_REST))
    colours[..., 3:] = FAINTEST + np.sqrt(np.abs(share)) * (STRONGEST - FAINTEST)
    return colours


def scale_strip(
    left: float, bottom: float, width: float, height: float, num_steps: int = 32
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The colours' scale as a strip of triangles: points 2K x 2 of a picture, colours 2K x 4."""
    along = np.linspace(0, 1, num_steps + 1)
    points = np.empty((num_steps + 1, 2, 2), dtype=np.float32)
    points[..., 0] = (left + along * width)[:, None]
    points[..., 1] = [bottom, bottom + height]
    colours = np.repeat(strain_colours(2 * along - 1, 1.0), 2, axis=0)
    colours[:, 3] = 1.0
    return points.reshape(-1, 2), colours
