# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command says while it works."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from time import monotonic
from typing import Any

from mimetic.shared.shown_text import shown

PLAIN_EVERY = 10.0  # seconds between lines where there is no terminal


def say(text: str, end: str = "\n") -> None:
    """A line on standard error: nothing where that is closed, full, or read by nobody any more.

    No work fails, and none is lost, because a line about it cannot be written.
    """
    with _unheard():
        if sys.stderr is not None:
            print(text, end=end, file=sys.stderr, flush=True)


def is_terminal() -> bool:
    """Whether somebody may be looking at standard error."""
    try:
        return sys.stderr is not None and sys.stderr.isatty()
    except ValueError:  # it was closed
        return False


@contextlib.contextmanager
def _unheard() -> Iterator[None]:
    """After the first failure nothing more is written, by Python at its end neither."""
    try:
        yield
    except (OSError, ValueError):  # ValueError: it was closed
        nowhere = open(os.devnull, "w")  # noqa: SIM115 - until the process ends
        # What is left in the stream would fail once more, and give another exit status
        with contextlib.suppress(OSError, ValueError, AttributeError):
            os.dup2(nowhere.fileno(), sys.stderr.fileno())
        sys.stderr = nowhere


class Console:
    """Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

    def __init__(self) -> None:
        self._bar = None
        self._last = monotonic()
        self._start = monotonic()
        if is_terminal():
            self._bar = _make_bar()

    def __enter__(self) -> Console:
        if self._bar:
            self._task = self._bar.add_task("starting", total=1.0, left="")
            bar, self._bar = self._bar, None  # one that did not start cannot be stopped
            with _unheard():
                bar.start()
                self._bar = bar
        return self

    def __exit__(self, *_exception: object) -> None:
        if self._bar:
            with _unheard():
                self._bar.stop()
            self._bar = None

    def show(self, fraction: float, text: str) -> None:
        if self._bar:
            left = self._time_left(fraction).removeprefix(", ")
            with _unheard():
                self._bar.update(self._task, completed=fraction, description=text, left=left)
        elif monotonic() - self._last >= PLAIN_EVERY:
            self._last = monotonic()
            say(f"{100 * fraction:3.0f} %  {text}{self._time_left(fraction)}")

    def tell(self, text: str) -> None:
        say(shown(text))

    def _time_left(self, fraction: float) -> str:
        if fraction < 0.02:
            return ""
        left = (monotonic() - self._start) * (1 - fraction) / fraction
        return f", {int(left) // 60}:{int(left) % 60:02d} left"


def _make_bar() -> Any:  # rich's Progress, or None without it
    try:
        from rich.console import Console as RichConsole
        from rich.progress import (
            BarColumn,
            Progress,
            TaskProgressColumn,
            TextColumn,
        )
    except ImportError:  # an optional extra: plain lines do without
        return None

    class OwnConsole(RichConsole):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # rich's own ends the program

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[left]}"),
        console=OwnConsole(stderr=True),
    )
