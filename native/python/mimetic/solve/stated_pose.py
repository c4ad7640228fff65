# SPDX-License-Identifier: GPL-3.0-or-later
"""A head's pose as a turn and a shift of the captured one, by numbers or by a drag."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.document import Performance
from mimetic.performance.projection import rescaled

RADIUS = 0.11  # metres from a head's origin to the middle of its face


def turned(
    performance: Performance, frame: int, degrees: ArrayLike, metres: ArrayLike
) -> NDArray[np.float64]:
    """4 x 4: the captured pose turned about the camera's axes (3) and moved along them (3).

    Raises InvalidInput.
    """
    pose = performance.head_pose[performance.index_of(frame)].copy()
    turn = _core.from_rotation_vectors(np.radians(np.asarray(degrees, dtype=np.float64))[None])[0]
    pose[:3, :3] = turn @ pose[:3, :3]
    pose[:3, 3] += np.asarray(metres, dtype=np.float64)
    if pose[2, 3] <= 0:
        raise InvalidInput(f"frame {frame}: the head would be behind the camera")
    return pose


@dataclass(frozen=True)
class PoseDrag:
    """A pose, as a turn and a shift of the captured one, that a drag changes."""

    performance: Performance
    frame: int
    degrees: Sequence[float]  # 3, as `correcting.with_turn` takes them
    metres: Sequence[float]  # 3

    def dragged(
        self, begin: tuple[float, float], end: tuple[float, float], mode: str
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Degrees and metres after a drag between pixels of the footage's file.

        `move` takes the head along in its distance from the camera, `turn` the face's middle by
        turning the head about its own origin, `roll` turns it about the view's axis. Raises
        InvalidInput.
        """
        performance = self.performance
        pose = turned(performance, self.frame, self.degrees, self.metres)
        size = performance.image_size
        stored = size if performance.stored_size is None else performance.stored_size
        pixels = np.vstack([rescaled(pixel, stored, size) for pixel in (begin, end)])
        lens = performance.intrinsics
        # At the head's distance, metres
        begin_at, end_at = pose[2, 3] * (pixels - lens[:2, 2]) / lens[[0, 1], [0, 1]]
        x, y = end_at - begin_at
        if mode == "move":
            return np.asarray(self.degrees), np.add(self.metres, [x, y, 0.0])
        # The face is nearer than the head's origin by its radius
        nearer = max(1 - RADIUS / pose[2, 3], 0.1) / RADIUS
        turn = [y * nearer, -x * nearer, 0.0]
        if mode == "roll":
            begin_arm, end_arm = begin_at - pose[:2, 3], end_at - pose[:2, 3]
            angle = math.atan2(end_arm[1], end_arm[0]) - math.atan2(begin_arm[1], begin_arm[0])
            turn = [0.0, 0.0, math.remainder(angle, math.tau)]
        turns = np.array([np.radians(self.degrees), turn], dtype=np.float64)
        first, then = _core.from_rotation_vectors(turns)
        both = np.ascontiguousarray(then @ first)
        return np.degrees(_core.rotation_vectors(both[None])[0]), np.asarray(self.metres)
