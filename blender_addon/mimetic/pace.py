# SPDX-License-Identifier: GPL-3.0-or-later
"""How often a job shows where it is: drawing takes the machine from the job, and from whoever works
in the window meanwhile."""

from __future__ import annotations

import time
from collections.abc import Callable

SHARE = 0.25  # of its time that the window may draw for a job's news
LATE = 1.5  # ticks after which an event comes late: Blender was drawing
LONGEST = 2.0  # seconds without news, however slowly the window draws
AT_REST = 0.5  # seconds without mouse and keys, after which nobody is taken to work in the window


class Pace:
    """Asked at every event of a timer. Blender draws between two of them: an event that is late
    says how long, also of what Blender draws again by itself, as 3D views do until their picture
    is smooth, and of what others have drawn. Whoever works in a slow window goes first.
    """

    def __init__(self, tick: float, now: Callable[[], float] = time.monotonic) -> None:
        """tick: seconds between two events of the timer, at best."""
        self._tick, self._now = tick, now
        self._last: float | None = None  # event
        self._shown_at = self._input_at = float("-inf")
        self._drawing = 0.0  # seconds since then

    def is_due(self) -> bool:
        """Whether news may be shown at this event."""
        now = self._now()
        since = now - (self._last if self._last is not None else now)
        self._last = now
        if since > LATE * self._tick:
            self._drawing += since
        if self._drawing > 0 and now - self._input_at < AT_REST:
            return False
        elapsed = now - self._shown_at
        return elapsed >= LONGEST or self._drawing <= SHARE * elapsed

    def has_input(self) -> None:
        """Mouse or keys were used in the window."""
        self._input_at = self._now()

    def has_shown(self) -> None:
        """Something was shown at this event, which Blender is going to draw."""
        self._shown_at, self._drawing = self._now(), 0.0
