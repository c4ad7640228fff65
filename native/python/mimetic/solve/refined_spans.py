# SPDX-License-Identifier: GPL-3.0-or-later
"""Which frames of a performance a refinement solves again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.performance.corrections import Corrections, texts_of
from mimetic.performance.document import Performance
from mimetic.solve.walk import runs_of

DIRECTIONS = ("both", "forward", "backward")
FIXED = 12  # frames beside those that are solved, which they join without a jump
FrameSpan = tuple[int, int]


def limits_of_change(
    performance: Performance,
    corrections: Corrections,
    frames: tuple[int | None, int | None] | None,
    direction: str,
) -> tuple[int, int]:
    """First and last frame that may change.

    frames: as asked for; direction: `forward` none before the first of the corrections, `backward`
    none after the last, `both`. Raises InvalidInput.
    """
    if direction not in DIRECTIONS:
        raise InvalidInput(f"direction {direction!r}: it must be one of {', '.join(DIRECTIONS)}")
    first, last = int(performance.frame[0]), int(performance.frame[-1])
    low, high = frames or (None, None)
    low = first if low is None else low
    high = last if high is None else high
    if low > high or high < first or low > last:
        raise InvalidInput(f"frames {low}:{high}: the performance has frames {first} to {last}")
    if corrections and direction == "forward":
        low = max(low, min(entry.frame for entry in corrections))
    if corrections and direction == "backward":
        high = min(high, max(entry.frame for entry in corrections))
    return low, high


def check_measured_within(
    performance: Performance,
    limits: tuple[int, int],
    before: Corrections,
    corrections: Corrections,
) -> None:
    """Raises InvalidInput for what would be left out: a correction is measured in its own frame.

    before: what is honoured already, and stays so where nothing that it reaches may change.
    """
    low, high = limits
    honoured = texts_of(before)
    for entry, text in zip(corrections, texts_of(corrections), strict=True):
        is_kept = text in honoured and not spans_of(performance, (entry,), limits)
        if not (low <= entry.frame <= high or is_kept):
            raise InvalidInput(
                f"frame {entry.frame} is corrected, but frames {low} to {high} alone may change: "
                f"let frame {entry.frame} change too, or leave its correction out"
            )


def spans_of(
    performance: Performance,
    corrections: Corrections,
    limits: tuple[int, int],
    others: NDArray[np.bool_] | None = None,
) -> list[FrameSpan]:
    """Rows that corrections reach in their own scenes, in runs of one scene, both ends included.

    others: N, rows beside them.
    """
    low, high = limits
    frame = performance.frame
    is_reached = np.zeros(len(frame), dtype=bool) if others is None else others.copy()
    for entry in corrections:
        row = int(np.searchsorted(frame, entry.frame, side="right")) - 1
        scene = scene_of(performance, max(0, row))
        is_reached[scene] |= np.abs(frame[scene] - entry.frame) <= int(entry.reach)
    rows = np.flatnonzero(is_reached & (low <= frame) & (frame <= high))
    return [
        run
        for scene in performance.scenes
        for run in runs_of(rows[(scene.start <= rows) & (rows < scene.stop)].tolist(), FIXED)
    ]


def scene_of(performance: Performance, row: int) -> slice:
    return next(scene for scene in performance.scenes if scene.start <= row < scene.stop)


def with_neighbours(performance: Performance, span: FrameSpan) -> tuple[int, int]:
    """Of a span and what it joins in its scene: the first row, and the one after the last."""
    begin, end = span
    scene = scene_of(performance, begin)
    return max(scene.start, begin - FIXED), min(scene.stop, end + 1 + FIXED)
