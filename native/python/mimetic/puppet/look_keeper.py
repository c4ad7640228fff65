# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks kept one by one, in any order, while a live session runs: for a host's buttons."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

from mimetic import InvalidInput
from mimetic.puppet.lesson import Pair, check_teachable
from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.live_session import Tell
from mimetic.puppet.pictures import Picture
from mimetic.puppet.shown_looks import HELD_FOR, LEAST_HELD, MOST_HELD, ShownLooks, is_over
from mimetic.puppet.taught_look import Look
from mimetic.puppet.templates import TaughtSet


class LookKeeper:
    """Asked from any thread; `begin`, `see` and `end` are the session's.

    old: a set of the same person that a camera taught, whose other looks stay.
    """

    def __init__(self, old: TaughtSet | None = None) -> None:
        self._old = old
        self._lock = threading.Lock()
        self._asked: list[Look] = []
        self._due: list[Look] = []  # of a clip's frames, by them
        self._look: Look | None = None  # that is being kept
        self._held: list[Pair] = []
        self._since = 0.0
        self._shown: ShownLooks | None = None
        self._num_heads = 0

    def begin(self, live: LiveFilter, tell: Tell) -> None:
        """A session begins; raises InvalidInput if a camera cannot teach the old set again."""
        if self._old is not None:
            check_teachable(self._old, live.names)
        self._tell = tell
        self._shown = ShownLooks(live, tell, self._old)

    def ask(self, look: Look) -> None:
        """Keeps a look: now, or, of a clip in a camera's place, about its `frame`."""
        with self._lock:
            if look.frame:
                self._due = sorted([*self._due, look], key=lambda one: one.frame)
            else:
                self._asked.append(look)

    @property
    def is_ready(self) -> bool:
        """Whether the person's head is known, so that looks can be kept."""
        return self._shown is not None and self._shown.is_ready

    @property
    def kept(self) -> list[str]:
        """Names of the looks that were kept."""
        with self._lock:
            return list(self._shown.kept) if self._shown else []

    @property
    def keeping(self) -> str:
        """Name of the look that is being kept, or ""."""
        look = self._look
        return look.name if look else ""

    def see(
        self, picture: Picture, state: LiveState | None, time_of: Callable[[int], float]
    ) -> None:
        """A picture, what the filter says of it, and when the source shows a frame."""
        shown = self._shown
        assert shown is not None
        with self._lock:
            sample = shown.see(picture, state)
            if shown.num_heads != self._num_heads:  # what is held is of another one
                self._num_heads, self._look = shown.num_heads, None
            self._take_next(picture.time, time_of, shown)
            if self._look is None:
                return
            if sample is not None and len(self._held) < MOST_HELD:
                self._held.append(sample)
            if is_over(picture.time - self._since, len(self._held)):
                look, self._look = self._look, None
                shown.keep(look, self._held)

    def end(self) -> None:
        """No picture comes any more: what is held is kept if it suffices, all else is told."""
        with self._lock:
            look, self._look = self._look, None
            left = [*self._asked, *self._due]
            self._asked, self._due = [], []
            if look is not None and self._shown is not None and len(self._held) >= LEAST_HELD:
                self._shown.keep(look, self._held)
            elif look is not None:
                left.insert(0, look)
        for one in left:
            what = f"frame {one.frame}" if one.frame else "it"
            self._tell(f"{one.name}: the session ended before {what} was kept")

    def taught(self) -> TaughtSet:
        """Of the looks that were kept so far; raises InvalidInput if there are too few."""
        if self._shown is None:
            raise InvalidInput("no look was kept, and nothing is written")
        with self._lock:
            return self._shown.taught()

    def _take_next(self, time: float, time_of: Callable[[int], float], shown: ShownLooks) -> None:
        # A look of a frame is held from before it on: the frame is in the middle
        if self._due and time >= time_of(self._due[0].frame) - HELD_FOR / 2:
            look = self._due.pop(0)
            if time > time_of(look.frame) + HELD_FOR / 2:
                self._tell(f"{look.name}: frame {look.frame} is past; play the clip from before it")
            else:
                self._asked.append(replace(look, frame=0))
        if self._look is not None or not self._asked:
            return
        look = self._asked.pop(0)
        if not shown.is_ready:
            self._tell(f"{look.name}: not kept, as the person's head is not known yet: wait for it")
            return
        self._look, self._held, self._since = look, [], time
