# SPDX-License-Identifier: GPL-3.0-or-later
"""What a take's curves may be off by: 90 % intervals as bands over the time, and in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic.character.gaze_shapes import gaze_sliders
from mimetic.character.shape import shape_of_values
from mimetic.performance.confounding import confounded_name
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.gaze import GAZE, seen_articulators
from mimetic.score.scores import INTERVAL_90

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Band:
    """Triangles of a curve's interval, points 3K x 2 (footage frame, the slider's value): where it
    is told apart, and where the pictures cannot tell it from another muscle."""

    told_apart: NDArray[np.float32]
    confounded: NDArray[np.float32]


@dataclass(frozen=True)
class ErrorBar:
    """A value as captured, and half of its interval; what it cannot be told from, or ""."""

    value: float
    half: float
    confounded_with: str


class ErrorBars:
    """Of the muscles, jaw, lids and lips of a performance, by the names of their sliders.

    has_gaze_sliders: of a head whose sliders turn the eyes and carry the lids along
    (`mimetic.character.shapes.slider_shapes_of`).
    """

    def __init__(self, performance: Performance, has_gaze_sliders: bool = False) -> None:
        self._performance = performance
        self._values = _values(performance, has_gaze_sliders)
        self._stds = dict(
            zip(performance.muscles, np.asarray(performance.activations_std).T, strict=True)
        )
        if performance.articulator_values_std is not None:
            columns = zip(
                performance.articulators, performance.articulator_values_std.T, strict=True
            )
            self._stds |= {name: column for name, column in columns if name not in GAZE}
        self._is_measured = performance.quality >= HELD_QUALITY

    def has(self, name: str) -> bool:
        return name in self._stds

    def at(self, name: str, frame: int) -> ErrorBar | None:
        """None where the frame was not captured, or the face was lost."""
        i = int(np.searchsorted(self._performance.frame, frame))
        if i == self._performance.num_frames or self._performance.frame[i] != frame:
            return None
        if not self.has(name) or not self._is_measured[i]:
            return None
        half = INTERVAL_90 * float(self._stds[name][i])
        other = confounded_name(self._performance, i, name)
        return ErrorBar(float(self._values[name][i]), half, other)

    def band(self, name: str) -> Band:
        """Between frames that follow each other; nothing where the face was lost."""
        frame = self._performance.frame
        values, half = self._values[name], INTERVAL_90 * self._stds[name]
        edges = np.stack([values - half, values + half])
        if name in self._performance.muscles:
            edges = np.clip(edges, 0, 1)  # what an activation can be
        corners = np.stack([np.broadcast_to(frame, edges.shape), edges], axis=2)
        is_piece = (np.diff(frame) == 1) & self._is_measured[1:] & self._is_measured[:-1]
        (a, b), (c, d) = corners[:, :-1], corners[:, 1:]
        triangles = np.stack([a, c, b, b, c, d], axis=1)  # N - 1 x 6 x 2
        is_confounded = self._is_confounded(name)
        is_confounded = is_confounded[1:] & is_confounded[:-1]
        return Band(
            _points(triangles[is_piece & ~is_confounded]),
            _points(triangles[is_piece & is_confounded]),
        )

    def _is_confounded(self, name: str) -> NDArray[np.bool_]:
        performance = self._performance
        if performance.confounded_with is None or name not in performance.muscles:
            return np.zeros(performance.num_frames, dtype=np.bool_)
        return performance.confounded_with[:, performance.muscles.index(name)] >= 0


def _values(performance: Performance, has_gaze_sliders: bool) -> dict[str, Floats]:
    """By name, N: what a slider is keyed with."""
    values = dict(zip(performance.muscles, performance.activations.T, strict=True))
    if len(performance.articulators):
        columns = seen_articulators(performance).T
        values |= dict(zip(performance.articulators, columns, strict=True))
    if not has_gaze_sliders:
        return values
    none = np.zeros((0, 3))
    shapes = [shape_of_values(name, "", none, column, 0.0) for name, column in values.items()]
    return {shape.name: shape.values for shape in gaze_sliders(performance, shapes)}


def _points(triangles: NDArray[np.float64]) -> NDArray[np.float32]:
    return np.ascontiguousarray(triangles.reshape(-1, 2), dtype=np.float32)
