# SPDX-License-Identifier: GPL-3.0-or-later
"""A source, the filter, and who wants its states: one live session."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic, perf_counter

import numpy as np

from mimetic.puppet.live_filter import LiveFilter, LiveState
from mimetic.puppet.pictures import Events, NewestPicture, Picture, Source

POLL = 0.05  # seconds between looks whether to stop
# Given each picture that was worked on and the face's state, None as long as there is no face;
# returns false to end
Listener = Callable[[Picture, LiveState | None], bool]
Tell = Callable[[str], None]


@dataclass
class SessionFigures:
    """How a session goes; times are of the last minute."""

    num_pictures: int = 0  # worked on
    num_skipped: int = 0  # overtaken by newer ones before they could be
    num_held: int = 0  # in which the face was not seen
    milliseconds: deque[float] = field(default_factory=lambda: deque(maxlen=1800))
    first_face: float | None = None  # seconds from the first picture to the first state
    seconds: float = 0.0

    @property
    def rate(self) -> float:
        """Pictures worked on, a second."""
        return self.num_pictures / self.seconds if self.seconds > 0 else 0.0

    def line(self) -> str:
        """For the user."""
        median = float(np.median(self.milliseconds)) if self.milliseconds else 0.0
        slow = float(np.quantile(self.milliseconds, 0.95)) if self.milliseconds else 0.0
        first = "no face" if self.first_face is None else f"the face after {self.first_face:.1f} s"
        return (
            f"{first}; {self.num_pictures} pictures in {self.seconds:.1f} s, "
            f"{self.rate:.1f} a second; {median:.0f} ms each (95 % under {slow:.0f}), "
            f"{self.num_skipped} skipped, face not seen in {self.num_held}"
        )


class LiveSession:
    """Runs a source in a thread of its own, and filter and listener in the caller's.

    The filter always gets the newest picture: who is late skips pictures, and never lags.
    """

    def __init__(
        self, source: Source, live_filter: LiveFilter, listener: Listener, tell: Tell
    ) -> None:
        self.source, self.filter = source, live_filter
        self.figures = SessionFigures()
        self._listener, self._tell = listener, tell
        self._pictures, self._events = NewestPicture(), Events()
        self._failure: BaseException | None = None

    def run(self, should_stop: Callable[[], bool] = lambda: False) -> None:
        """Until the source ends, `should_stop` or the listener says so.

        Raises what a source raises that fails before its first picture; a camera or file that fails
        later is told, and the session ends.
        """
        feeder = threading.Thread(target=self._feed, name="source", daemon=True)
        feeder.start()
        start: float | None = None
        try:
            while not should_stop():
                is_closed = self._pictures.is_closed  # before: the last may come while this waits
                picture = self._pictures.take(POLL)
                self._tell_events()
                if picture is None:
                    if is_closed:
                        break
                    continue
                start = monotonic() if start is None else start
                if not self._work_on(picture, start):
                    break
        finally:
            self._events.stop()
            self._pictures.close()
            feeder.join()
            self.filter.stop()
        self._tell_events()
        if self._failure is not None:
            if not self.figures.num_pictures or not isinstance(self._failure, OSError):
                raise self._failure
            self._tell(str(self._failure))

    def _work_on(self, picture: Picture, start: float) -> bool:
        if picture.is_new_view:
            self.filter.start_over()
        began = perf_counter()
        state = self.filter.advance(picture.image, picture.time)
        while self.filter.remarks:
            self._tell(self.filter.remarks.pop(0))
        figures = self.figures
        figures.milliseconds.append(1000 * (perf_counter() - began))
        figures.num_pictures += 1
        figures.num_skipped = self._pictures.num_skipped
        figures.num_held += state is None or state.is_held
        figures.seconds = monotonic() - start
        if state is not None and figures.first_face is None:
            figures.first_face = figures.seconds
        return self._listener(picture, state)

    def _feed(self) -> None:
        try:
            self.source.feed(self._pictures, self._events)
        except BaseException as error:
            self._failure = error
        finally:
            self._pictures.close()

    def _tell_events(self) -> None:
        while self._events.lines:
            self._tell(self._events.lines.pop(0))
