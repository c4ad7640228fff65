# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes of a performance: eyeballs that turn rigidly, and upper lids that go along.

Degrees, positive to the subject's left and up.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core

SIDES = ("L", "R")
GAZE = tuple(f"gaze_{axis}.{side}" for side in SIDES for axis in ("yaw", "pitch"))
# What a file must have so that its gaze turns eyes
EYE_KEYS = ("eye_centers", "iris_centers", "eye_of_vertex", "lid_following")
IRIS_RADIUS = 5.9e-3  # metres, of people; the canonical head's eyes are painted so
NUM_RIM = 24
FAR_GAZE = 30.0  # degrees


class WithEyes(Protocol):
    """The keys of a performance that concern its eyes."""

    articulators: list[str]
    articulator_values: NDArray[np.float64]
    neutral_vertices: NDArray[np.float64]
    eye_centers: NDArray[np.float64] | None
    iris_centers: NDArray[np.float64] | None
    eye_of_vertex: NDArray[np.int64] | None
    lid_following: NDArray[np.float64] | None


def has_gaze(performance: WithEyes) -> bool:
    """Whether the eyes turn: a performance of an earlier version leaves them as they are."""
    return performance.eye_centers is not None


def gaze_of(performance: WithEyes) -> NDArray[np.float64]:
    """N x 4 degrees, in the order of GAZE."""
    return performance.articulator_values[:, [performance.articulators.index(n) for n in GAZE]]


def gaze_range(performance: WithEyes) -> NDArray[np.float64]:
    """2 x 2 degrees: lowest and highest yaw, then pitch, of 98 of 100 frames."""
    low, high = np.quantile(gaze_of(performance), [0.01, 0.99], axis=0)
    return np.array([[low[axis::2].min(), high[axis::2].max()] for axis in (0, 1)])


def seen_articulators(performance: WithEyes, frames: slice = slice(None)) -> NDArray[np.float64]:
    """Rows x A: what the articulators' modes are multiplied by.

    Upper lids are lower than their own closure says where the eye looks down.
    """
    values = performance.articulator_values[frames]
    if not has_gaze(performance):
        return values
    values = values.copy()
    for side, follow in zip(SIDES, _lids_of(performance), strict=True):
        if (lid := f"lid_upper.{side}") in performance.articulators:
            column = performance.articulators.index(lid)
            pitch = values[:, performance.articulators.index(f"gaze_pitch.{side}")]
            values[:, column] = follow.seen(values[:, column], pitch)
    return values


def own_articulators(performance: WithEyes, seen: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x A articulators' values from what is seen of them: the inverse of `seen_articulators`."""
    values = seen.copy()
    if not has_gaze(performance):
        return values
    for side, follow in zip(SIDES, _lids_of(performance), strict=True):
        if (lid := f"lid_upper.{side}") in performance.articulators:
            column = performance.articulators.index(lid)
            pitch = values[:, performance.articulators.index(f"gaze_pitch.{side}")]
            values[:, column] = follow.own(values[:, column], pitch)
    return values


def expression_of(performance: WithEyes) -> NDArray[np.float64]:
    """N x A: how far each articulator is from rest, of which 1 is far; gaze is in degrees."""
    return performance.articulator_values / value_units(performance.articulators)


def value_units(names: Sequence[str], degrees: float = FAR_GAZE) -> NDArray[np.float64]:
    """What of each muscle's or articulator's value is far from rest, as an activation of 1 is;
    degrees: of a gaze."""
    return np.array([degrees if name in GAZE else 1.0 for name in names])


def with_eyes_turned(
    performance: WithEyes, i: int, vertices: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Vertices (V x 3, head frame) with the eyeballs as they are at frame index i.

    What moves a vertex beside, comes on top of the turn of the neutral's, as shapes add up.
    """
    if not has_gaze(performance):
        return vertices
    turns = np.ascontiguousarray(gaze_of(performance)[i])
    eye_of = np.asarray(performance.eye_of_vertex, dtype=np.int32)
    rest, centers = performance.neutral_vertices, np.asarray(performance.eye_centers)
    return vertices + _core.turned_eyeballs(rest, eye_of, centers, turns) - rest


def iris_circles(performance: WithEyes, i: int) -> NDArray[np.float64]:
    """2 x (1 + NUM_RIM) x 3, metres, head frame: each iris' middle and its rim at frame index i."""
    centers, irises = map(np.asarray, (performance.eye_centers, performance.iris_centers))
    return turned_irises(centers, irises, gaze_of(performance)[i])


def turned_irises(
    centers: NDArray[np.float64], irises: NDArray[np.float64], turns: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The same of eyeballs (2 x 3 each, metres: centres, irises at rest) at a gaze (4, as GAZE)."""
    return np.stack(
        [
            _core.iris_circle(
                *(centers[eye], irises[eye], turns[2 * eye], turns[2 * eye + 1]),
                *(IRIS_RADIUS, NUM_RIM),
            )
            for eye in range(2)
        ]
    )


def modes_with_gaze(modes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Modes of articulators (A x V x 3), then of GAZE, which displaces nothing: eyes turn."""
    return np.concatenate([modes, np.zeros_like(modes[: len(GAZE)])])


def check_eyes(performance: WithEyes, num_vertices: int) -> None:
    """Raises InvalidInput where the keys that concern eyes do not belong together."""
    keys = [key for key in EYE_KEYS if getattr(performance, key) is not None]
    if not keys:
        return
    missing = [key for key in EYE_KEYS if key not in keys]
    missing += [name for name in GAZE if name not in performance.articulators]
    if missing:
        raise InvalidInput(f"performance has {keys[0]} without {', '.join(missing)}")
    eye_of = np.asarray(performance.eye_of_vertex)
    counts = [int((eye_of == eye).sum()) for eye in (0, 1, 2)]
    if sum(counts) != num_vertices or 0 in counts[1:]:
        raise InvalidInput("performance eye_of_vertex must be 0, 1 (left eye) or 2 (right eye)")


def _lids_of(performance: WithEyes) -> list[_core.LidFollowing]:
    return [
        _core.LidFollowing(float(row[0]), float(row[1]))
        for row in np.asarray(performance.lid_following)
    ]
