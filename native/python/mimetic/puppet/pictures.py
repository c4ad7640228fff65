# SPDX-License-Identifier: GPL-3.0-or-later
"""The newest picture of a source, and no queue of older ones: who is late skips, and never lags."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Picture:
    """A picture of a source.

    image: H x W x 3 uint8, red, green, blue; time: seconds since the source's first; arrival: the
    same by `monotonic`'s clock; is_new_view: the pictures before it were of another shape, so that
    nothing known of them holds.
    """

    image: NDArray[np.uint8]
    time: float
    arrival: float
    is_new_view: bool = False


class NewestPicture:
    """One place for one picture, between the thread of a source and that of a session."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._picture: Picture | None = None
        self.is_closed = False  # no other will come
        self.num_put = self.num_skipped = 0

    def put(self, picture: Picture, waits: bool = False) -> None:
        """Replaces what was not taken; waits: until it was, instead."""
        with self._condition:
            while waits and self._picture is not None and not self.is_closed:
                self._condition.wait()
            if self._picture is not None:
                self.num_skipped += 1
                is_new_view = picture.is_new_view or self._picture.is_new_view
                picture = replace(picture, is_new_view=is_new_view)
            self._picture = picture
            self.num_put += 1
            self._condition.notify_all()

    def take(self, timeout: float) -> Picture | None:
        """The newest that was not taken yet; None if there is none within `timeout` seconds."""
        with self._condition:
            if self._picture is None and not self.is_closed:
                self._condition.wait(timeout)
            picture, self._picture = self._picture, None
            self._condition.notify_all()
            return picture

    def close(self) -> None:
        with self._condition:
            self.is_closed = True
            self._condition.notify_all()


class Source(Protocol):
    """What gives pictures, in a thread that the session runs `feed` in."""

    name: str
    size: tuple[int, int]  # width, height, pixels
    fps: float  # nominal

    def time_of(self, frame: int) -> float:
        """Seconds from the first picture to another, by its number from 1."""

    def feed(self, pictures: NewestPicture, events: Events) -> None:
        """Puts pictures until there are no more or `events.is_stopped`; raises UnreadableMedia."""


class Events:
    """What a source says to the user, a line each, and whether it is to stop."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._stop = threading.Event()

    def say(self, line: str) -> None:
        self.lines.append(line)

    @property
    def is_stopped(self) -> bool:
        return self._stop.is_set()

    def stop(self) -> None:
        self._stop.set()

    def wait(self, seconds: float) -> bool:
        """Whether it is to stop, after so many seconds or at once when it is asked to."""
        return self._stop.wait(seconds)
