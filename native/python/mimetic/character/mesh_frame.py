# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a mesh's points went elsewhere all together, as when a program applies an object's
transform to them: what was noted in the frame of before goes along then."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

NUM_MARKS = 8  # four would do; more of them average what rounding adds
NEAR = 1e-5  # of the marks' extent: on a head less than a hundredth of a millimetre
FLAT = 1e-10  # of the cube of the marks' spread: a plane's thickness is rounding
SINGLE = 4 * float(np.finfo(np.float32).eps)  # coordinates are single precision


def marks_of(points: ArrayLike) -> NDArray[np.int64]:
    """NUM_MARKS vertices that lie far from each other; points: V x 3, at least one."""
    points = np.asarray(points, dtype=np.float64)
    marks = [int(_squares(points - points.mean(axis=0)).argmax())]
    distances = _squares(points - points[marks[0]])
    while len(marks) < NUM_MARKS:
        marks.append(int(distances.argmax()))
        distances = np.minimum(distances, _squares(points - points[marks[-1]]))
    return np.array(marks)


def now_from_noted(noted: ArrayLike, now: ArrayLike) -> NDArray[np.float64]:
    """4 x 4, by which marks (K x 3) went from where they were noted to where they are now.

    The identity if they stayed, if they did not go all together, or lie in a plane.
    """
    before, after = (np.asarray(rows, dtype=np.float64) for rows in (noted, now))
    near = NEAR * float(np.ptp(after, axis=0).max()) + SINGLE * float(np.abs(after).max())
    if np.abs(after - before).max() <= near:
        return np.eye(4)
    origin, target = before.mean(axis=0), after.mean(axis=0)
    turned = _nearest_map(before - origin, after - target)
    moved = np.eye(4)
    moved[:3, :3], moved[:3, 3] = turned, target - turned @ origin
    is_whole = np.abs(before @ turned.T + moved[:3, 3] - after).max() <= near
    return moved if is_whole and _determinant(turned) != 0 else np.eye(4)


def _nearest_map(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]:
    """3 x 3 of least squares from K x 3 to K x 3, both about their means; 0 of a plane."""
    normal = before.T @ before
    cofactors = np.array([np.cross(normal[i - 2], normal[i - 1]) for i in range(3)])
    determinant = float(normal[0] @ cofactors[0])
    if determinant <= FLAT * float(np.trace(normal)) ** 3:
        return np.zeros((3, 3))
    return after.T @ before @ cofactors / determinant


def _determinant(matrix: NDArray[np.float64]) -> float:
    return float(matrix[0] @ np.cross(matrix[1], matrix[2]))


def _squares(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the lengths of rows (N x 3)."""
    return np.square(rows).sum(axis=1)
