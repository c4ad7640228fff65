# SPDX-License-Identifier: GPL-3.0-or-later
"""What a list of takes says of a performance: frames, quality, where the face was lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimetic.performance.document import HELD_QUALITY, Performance


@dataclass(frozen=True)
class TakeFacts:
    first: int  # footage frames
    last: int
    quality: float  # the median
    num_held: int
    held: list[tuple[int, int]]  # first and last index of each run of held frames


def facts_of(performance: Performance) -> TakeFacts:
    is_held = performance.quality < HELD_QUALITY
    ends = np.flatnonzero(np.diff(np.concatenate([[False], is_held, [False]])))
    return TakeFacts(
        int(performance.frame[0]),
        int(performance.frame[-1]),
        float(np.median(performance.quality)),
        int(is_held.sum()),
        [(int(first), int(after) - 1) for first, after in ends.reshape(-1, 2)],
    )
