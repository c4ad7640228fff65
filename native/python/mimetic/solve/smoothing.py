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
    before: list[_core.FrameEstimate],
    motion: _core.FaceMotion,
    count_seconds: Callable[[float], None],
    options: _core.SmootherOptions | None = None,
) -> Iterator[State]:
    """Smoothed states; memory holds one window.

    estimates: frame numbers in the order of walking, None where nothing can be measured: the state
    before is held there, and what lies on both sides is smoothed apart. before: estimates that
    precede the first, not given out again.
    """
    waiting = [(0, estimate) for estimate in before]
    num_given = len(waiting)
    last = before[-1] if before else None

    def smooth(until: int) -> list[State]:
        start = time.perf_counter()
        window = [estimate for _, estimate in waiting]
        smoothed_estimates = _core.smooth(window, motion, options or _core.SmootherOptions())
        count_seconds(time.perf_counter() - start)
        is_held = [_is_held(estimate) for estimate in smoothed_estimates]
        return [
            State(waiting[i][0], smoothed_estimates[i], is_held[i]) for i in range(num_given, until)
        ]

    for frame, estimate in estimates:
        if estimate is not None:
            waiting.append((frame, estimate))
            if len(waiting) >= WINDOW + 2 * OVERLAP:
                states = smooth(len(waiting) - OVERLAP)
                yield from states
                last = states[-1].estimate
                waiting, num_given = waiting[-2 * OVERLAP :], OVERLAP
            continue
        if len(waiting) > num_given:
            states = smooth(len(waiting))
            yield from states
            last = states[-1].estimate
        waiting, num_given = [], 0
        if last is not None:
            yield State(frame, last, held=True)
    if len(waiting) > num_given:
        yield from smooth(len(waiting))


def _is_held(estimate: _core.FrameEstimate) -> bool:
    return estimate.held or estimate.quality < HELD_QUALITY
