# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame as a correction states it, before a refinement weighs that against the pictures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.extras import LIP_CLOSING
from mimetic.muscles.feature_lines import feature_lines
from mimetic.performance.corrections import FrameCorrection
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, gaze_of, has_gaze, seen_articulators
from mimetic.template.face_template import FaceTemplate, load_template

GAP_SHARES = (0.3, 0.5, 0.7)  # of the way from corner to corner: where the lips' gap is measured


@dataclass
class FrameState:
    """What moves the surface in one frame."""

    activations: NDArray[np.float64]  # M
    articulators: NDArray[np.float64]  # A, as seen: what their modes are multiplied by
    gaze: NDArray[np.float64] | None  # 4 degrees, as GAZE; None: eyes that do not turn
    head_pose: NDArray[np.float64]  # 4 x 4, camera from head


def captured_state(performance: Performance, i: int) -> FrameState:
    """Of frame index `i`."""
    return FrameState(
        performance.activations[i].copy(),
        seen_articulators(performance, slice(i, i + 1))[0].copy(),
        gaze_of(performance)[i].copy() if has_gaze(performance) else None,
        performance.head_pose[i],
    )


def stated_state(performance: Performance, i: int, entry: FrameCorrection) -> FrameState:
    """The same with an entry's values and pose in place of the captured ones; pins move nothing.

    Names that the performance has not are left out.
    """
    state = captured_state(performance, i)
    gaze_pins = []
    for name, pinned in entry.values.items():
        if name in GAZE:
            gaze_pins.append((0, GAZE.index(name), pinned.value, pinned.std, entry.reach))
        elif name in performance.muscles:
            state.activations[performance.muscles.index(name)] = pinned.value
        elif name in performance.articulators:
            state.articulators[performance.articulators.index(name)] = pinned.value
    if gaze_pins and state.gaze is not None:
        # Both eyes go along with one, as in the refinement
        state.gaze = _core.corrected_gaze(np.ascontiguousarray(state.gaze[None]), gaze_pins)[0]
    if entry.lip_gap is not None:
        _part_lips(performance, i, state, entry.lip_gap.value)
    if entry.pose is not None:
        state.head_pose = entry.pose.head_pose
    return state


def states_more_than_pins(entry: FrameCorrection | None) -> bool:
    """Whether a frame as stated is another than the captured one."""
    return entry is not None and bool(entry.values or entry.pose or entry.lip_gap)


@lru_cache(maxsize=2)
def gap_places(template: FaceTemplate) -> list[tuple[int, int]]:
    """Vertices of the upper and the lower lip's inner edge between which the gap is measured."""
    lines = feature_lines(template)
    upper, lower = lines["lip_upper_inner"], lines["lip_lower_inner"]
    return [
        (upper[round(share * (len(upper) - 1))], lower[round(share * (len(lower) - 1))])
        for share in GAP_SHARES
    ]


def lip_gap_of(performance: Performance, i: int) -> float:
    """Metres between the lips' inner edges at frame index `i`; 0 of another mesh than ours."""
    return _gap(performance, i, captured_state(performance, i)) if _is_ours(performance) else 0.0


def _is_ours(performance: Performance) -> bool:
    return np.array_equal(performance.faces, load_template().faces)


def _gap(performance: Performance, i: int, state: FrameState) -> float:
    """Metres; linear in all that moves the surface."""
    parts = [
        (state.activations, performance.muscle_modes),
        (state.articulators, performance.articulator_modes),
    ]
    if performance.detail_coefficients is not None:
        parts.append((performance.detail_coefficients[i], performance.detail_modes))
    moved = (values @ _gaps(modes) for values, modes in parts if modes is not None)
    return float(_gaps(performance.neutral_vertices) + sum(moved))


def _gaps(vertices: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """What vertices, or displacements of them (... x V x 3), add to the gap (...)."""
    top, bottom = np.array(gap_places(load_template())).T
    return (vertices[..., top, 1] - vertices[..., bottom, 1]).mean(axis=-1, dtype=np.float64)


def _part_lips(performance: Performance, i: int, state: FrameState, gap: float) -> None:
    """Moves both lips alike, by the shapes that close them, until the gap is as stated."""
    columns = [
        performance.articulators.index(name)
        for name in LIP_CLOSING
        if name in performance.articulators
    ]
    if not columns or performance.articulator_modes is None or not _is_ours(performance):
        return
    for_one = float(_gaps(performance.articulator_modes)[columns].sum())
    state.articulators[columns] += (gap - _gap(performance, i, state)) / for_one
