# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn of captures, found once for all editors that draw it."""

from __future__ import annotations

from functools import cached_property

from .. import jobs, native, scene_in, shown_take

NUM_KEPT = 2  # takes: editors may show different clips


class Seen:
    """A take, or the capture at work, as it was last drawn."""

    def __init__(self, performance=None, so_far=None) -> None:
        """One of them: a Performance, or the FramesSoFar of a capture at work."""
        self.performance, self.so_far = performance, so_far
        self.drawn: tuple | None = None  # a frame's index, batches of what is drawn in it
        # A frame's index, what corrects it, batches of lines without marks
        self.stated: tuple | None = None
        self.strip: tuple | None = None  # what it was made for, and its batch

    @cached_property
    def lines(self):
        """Of mimetic.report.face_lines; None: a head's alone has no face."""
        parts = native.face_lines()
        if self.performance is None:
            return parts.LinesSoFar(self.so_far)
        try:
            return parts.PerformanceLines(self.performance)
        except native.known_errors():
            return None

    def row_of(self, frame: int) -> int | None:
        """None where no face is to be drawn."""
        return self.lines.row_of(frame) if self.lines is not None else None

    def qualities(self) -> tuple:
        """Footage frames, and the quality of each."""
        if self.performance is None:
            return self.so_far.qualities()
        return self.performance.frame, self.performance.quality

    def quality_of(self, frame: int):
        """A FrameQuality, or None where there is none."""
        if self.performance is None:
            return self.so_far.quality_of(frame)
        return native.take_facts().quality_of(self.performance, frame)


_takes: list[Seen] = []
at_work: Seen | None = None  # the capture that runs, as it was last drawn


def forget() -> None:
    global at_work
    at_work = None
    _takes.clear()


def last_take() -> Seen | None:
    """The take that was read last for drawing."""
    return _takes[-1] if _takes else None


def of_work(context) -> Seen | None:
    """What the job at work has followed of the clip on show."""
    global at_work
    run, clip = jobs.running, scene_in.clip_of(context)
    so_far = run.so_far if run and clip and run.subject == clip.name else None
    if so_far is None:
        # Kept until then: another editor may show another clip
        at_work = at_work if run else None
        return None
    if not len(so_far):
        return None
    if at_work is None or at_work.so_far is not so_far:
        at_work = Seen(so_far=so_far)
    return at_work


def of_take(context) -> Seen | None:
    """The take of the clip on show, or of the scene while it has no clip."""
    performance = shown_take.performance_or_none(context)
    if performance is None:
        return None
    seen = next((one for one in _takes if one.performance is performance), None)
    if seen is None:
        seen = Seen(performance)
        _takes.append(seen)
        del _takes[:-NUM_KEPT]
    return seen
