# SPDX-License-Identifier: GPL-3.0-or-later
"""The states of a clip's frames: smoothed window by window, collected row by row."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator

from mimetic import _core
from mimetic.performance.document import HELD_QUALITY
from mimetic.performance.rows import State

WINDOW, OVERLAP = 300, 40  # frames smoothed at once, and shared with the next window


def smooth_in_windows(
    estimates: Iterable[tuple[int, _core.FrameEstimate | None]],
    before: list[tuple[int, _core.FrameEstimate]],
    motion: _core.FaceMotion,
    count_seconds: Callable[[float], None],
    options: _core.SmootherOptions,
    is_cut_between: Callable[[int, int], bool],
) -> Iterator[State]:
    """Smoothed states; memory holds one window.

    estimates: frame numbers in the order of walking, None where nothing can be measured: the state
    before is held there, and what lies on both sides is smoothed apart, as it is on both sides of
    a cut. before: those that precede the first, not given out again.
    """
    waiting = list(before)
    num_given = len(waiting)
    last = before[-1][1] if before else None

    def smooth(until: int) -> list[State]:
        nonlocal last
        if until <= num_given:
            return []
        start = time.perf_counter()
        window = [estimate for _, estimate in waiting]
        smoothed_estimates = _core.smooth(window, motion, options)
        count_seconds(time.perf_counter() - start)
        is_held = [_is_held(estimate) for estimate in smoothed_estimates]
        last = smoothed_estimates[until - 1]
        return [
            State(waiting[i][0], smoothed_estimates[i], is_held[i]) for i in range(num_given, until)
        ]

    for frame, estimate in estimates:
        if estimate is None or (waiting and is_cut_between(waiting[-1][0], frame)):
            yield from smooth(len(waiting))
            waiting, num_given = [], 0
        if estimate is None:
            if last is not None:
                yield State(frame, last, held=True)
            continue
        waiting.append((frame, estimate))
        if len(waiting) >= WINDOW + 2 * OVERLAP:
            yield from smooth(len(waiting) - OVERLAP)
            waiting, num_given = waiting[-2 * OVERLAP :], OVERLAP
    yield from smooth(len(waiting))


def _is_held(estimate: _core.FrameEstimate) -> bool:
    return estimate.held or estimate.quality < HELD_QUALITY
