# SPDX-License-Identifier: GPL-3.0-or-later
"""What a list of takes says of a performance: frames, quality, where the face was lost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mimetic.performance.corrections import corrected_frames
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.shared.note_beginnings import CALIBRATED, HEAD_ALONE
from mimetic.shared.pinhole import FULL_FRAME_MM


@dataclass(frozen=True)
class TakeFacts:
    first: int  # footage frames
    last: int
    quality: float  # the median
    num_held: int
    held: list[tuple[int, int]]  # first and last index of each run of held frames
    focal_mm: float  # of the lens, as on a sensor 36 mm wide
    is_calibrated: bool  # to the person
    is_head_alone: bool
    num_corrected: int  # frames


class FrameQuality(NamedTuple):
    value: float  # from 0, lost, to 1, well explained
    is_held: bool  # the face was lost, and is as it was last seen
    is_corrected: bool  # by a person, in the performance itself


def facts_of(performance: Performance) -> TakeFacts:
    is_held = performance.quality < HELD_QUALITY
    return TakeFacts(
        int(performance.frame[0]),
        int(performance.frame[-1]),
        float(np.median(performance.quality)),
        int(is_held.sum()),
        runs(is_held),
        float(FULL_FRAME_MM * performance.intrinsics[0, 0] / performance.image_size[0]),
        _has_note(performance, CALIBRATED),
        _has_note(performance, HEAD_ALONE),
        len(performance.corrections or ()),
    )


def runs(flags: ArrayLike) -> list[tuple[int, int]]:
    """First and last index of each run of true ones among N."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return [(int(first), int(after) - 1) for first, after in ends.reshape(-1, 2)]


def quality_of(performance: Performance, frame: int) -> FrameQuality | None:
    """None: the frame was not captured."""
    rows = np.flatnonzero(performance.frame == frame)
    if not len(rows):
        return None
    value = float(performance.quality[rows[0]])
    return FrameQuality(value, value < HELD_QUALITY, frame in corrected_frames(performance))


def _has_note(performance: Performance, beginning: str) -> bool:
    return any(note.startswith(beginning) for note in performance.notes or ())
