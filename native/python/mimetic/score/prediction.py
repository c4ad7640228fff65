# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a performance says that points of its first frame go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.document import Performance
from mimetic.performance.places import RefinedSurface, places_under


@dataclass(frozen=True)
class Followed:
    """N frames, K points."""

    tracks: NDArray[np.float64]  # N x K x 2, pixels
    points: NDArray[np.float64]  # N x K x 3, metres, the performance's head frame; nan off the face
    on_face: NDArray[np.bool_]  # K, whether the surface covers the point in the first frame


def follow(performance: Performance, pixels: NDArray[np.float64]) -> Followed:
    """Follows pixels (K,2) of the first frame on the nearest surface under them.

    A point that the surface does not cover moves as the nearest skin does. Raises InvalidInput if
    it covers none.
    """
    surface = RefinedSurface(performance)
    under = places_under(surface, pixels)
    if under is None or not under.on_face.any():
        raise InvalidInput("the performance's face covers no point of the truth in the first frame")
    places = _core.SkinPlaces(surface.triangles[under.triangle], under.weights)
    tracks = np.empty((performance.num_frames, len(pixels), 2))
    points = np.full((performance.num_frames, len(pixels), 3), np.nan)
    for i in range(performance.num_frames):
        pose = performance.head_pose[i]
        in_camera = places.positions(surface.in_camera(i))
        tracks[i] = performance.project(in_camera) + under.offset
        points[i, under.on_face] = ((in_camera - pose[:3, 3]) @ pose[:3, :3])[under.on_face]
    return Followed(tracks, points, under.on_face)
