# SPDX-License-Identifier: GPL-3.0-or-later
"""Which frames of a performance a refinement solves again."""

from __future__ import annotations

import numpy as np

from mimetic import InvalidInput
from mimetic.performance.corrections import Corrections
from mimetic.performance.document import Performance

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


def spans_of(
    performance: Performance, corrections: Corrections, limits: tuple[int, int]
) -> list[FrameSpan]:
    """Rows that corrections reach, in runs, both ends included."""
    low, high = limits
    spans: list[FrameSpan] = []
    for entry in sorted(corrections, key=lambda entry: entry.frame - entry.reach):
        begin = max(low, entry.frame - int(entry.reach))
        end = min(high, entry.frame + int(entry.reach))
        if begin > end:
            continue
        begin, end = (
            int(np.searchsorted(performance.frame, begin)),
            int(np.searchsorted(performance.frame, end, side="right")) - 1,
        )
        if spans and begin <= spans[-1][1] + FIXED:
            spans[-1] = spans[-1][0], max(end, spans[-1][1])
        elif begin <= end:
            spans.append((begin, end))
    return spans
