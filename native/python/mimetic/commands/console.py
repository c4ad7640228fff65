# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command says while it works."""

from __future__ import annotations

import sys
from time import monotonic
from typing import Any

from mimetic.shared.shown_text import shown

PLAIN_EVERY = 10.0  # seconds between lines where there is no terminal


class Console:
    """Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

    def __init__(self) -> None:
        self._bar = None
        self._last = monotonic()
        self._start = monotonic()
        if sys.stderr.isatty():
            self._bar = _make_bar()

    def __enter__(self) -> Console:
        if self._bar:
            self._bar.start()
            self._task = self._bar.add_task("starting", total=1.0, left="")
        return self

    def __exit__(self, *_exception: object) -> None:
        if self._bar:
            self._bar.stop()
            self._bar = None

    def show(self, fraction: float, text: str) -> None:
        if self._bar:
            left = self._time_left(fraction).removeprefix(", ")
            self._bar.update(self._task, completed=fraction, description=text, left=left)
        elif monotonic() - self._last >= PLAIN_EVERY:
            self._last = monotonic()
            print(f"{100 * fraction:3.0f} %  {text}{self._time_left(fraction)}", file=sys.stderr)

    def tell(self, text: str) -> None:
        print(shown(text), file=sys.stderr)

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
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[left]}"),
        console=RichConsole(stderr=True),
    )
