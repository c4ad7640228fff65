# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C, SIGTERM and SIGHUP, of a terminal that is closed: a command ends cleanly on each, and its
exit status says on which. One that is ignored when the process starts (Ctrl-C by a job that a
script runs in the background, SIGHUP by nohup) stays so.

Nothing is imported here that takes time: signals are handled from a process's first moments.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType

HANGUP = getattr(signal, "SIGHUP", None)  # Windows has none
SIGNALS = (signal.SIGINT, signal.SIGTERM, *([HANGUP] if HANGUP else []))


class Ended(KeyboardInterrupt):
    """A signal asks to end at once."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.status = exit_status(number)


class Interrupt:
    """Whether a signal has asked to stop (call it), and the exit status for that signal."""

    number: int | None = None  # of the signal

    def __call__(self) -> bool:
        return self.number is not None

    @property
    def status(self) -> int:
        """0 as long as no signal came."""
        return 0 if self.number is None else exit_status(self.number)


def exit_status(number: int) -> int:
    """As shells have it: 129 for SIGHUP, 130 for Ctrl-C, 143 for SIGTERM."""
    return 128 + number


def exit_on_signals() -> None:
    """While a process loads what it needs there is nothing to keep: it ends without a traceback.

    An exception would not do: from inside of compiled modules it comes out as an ImportError.
    """

    def leave(number: int, _frame: FrameType | None) -> None:
        _tell("mimetic: stopped\n")
        os._exit(exit_status(number))

    for number in _heard():
        signal.signal(number, leave)
    if hasattr(signal, "pthread_sigmask"):  # scripts/mimetic holds them back while Python starts
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def ignore_signals() -> None:
    """All is done and reported; the process is about to end."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


@contextlib.contextmanager
def signals_raised() -> Iterator[None]:
    """Signals raise Ended in the block, so that everything on the way out is cleaned up."""
    interrupt = Interrupt()

    def end(number: int, _frame: FrameType | None) -> None:
        if interrupt() and number == HANGUP:
            return  # see `listen_for_interrupt`
        interrupt.number = number
        raise Ended(number)

    with _handled(end):
        yield


@contextlib.contextmanager
def listen_for_interrupt(outcome: str = "keeping what is done") -> Iterator[Interrupt]:
    """The first signal asks to finish what is begun, the second ends at once.

    A SIGHUP is no second one: a terminal that closes sends it, and its shell once more, and systems
    send it after SIGTERM; nobody insists. outcome: what becomes of the work, for the message to the
    user.
    """
    interrupt = Interrupt()

    def ask(number: int, _frame: FrameType | None) -> None:
        if interrupt() and number == HANGUP:
            return
        if interrupt():
            raise Ended(number)
        interrupt.number = number
        names: dict[int, str] = {signal.SIGINT: "Ctrl-C again", signal.SIGTERM: "SIGTERM again"}
        _tell(f"\nstopping: {outcome} ({names.get(number, 'SIGTERM')} ends at once)\n")

    with _handled(ask):
        try:
            yield interrupt
        except KeyboardInterrupt as request:
            if interrupt.number is None or isinstance(request, Ended):
                raise
            raise Ended(interrupt.number) from None  # work that gave up when it was asked to


def _tell(text: str) -> None:
    """Past Python's own stream: a signal may come while that is being written."""
    with contextlib.suppress(OSError):
        os.write(2, text.encode())


def _heard() -> list[signal.Signals]:
    """Those that nobody wants to be ignored."""
    return [number for number in SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]


@contextlib.contextmanager
def _handled(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():  # no other may handle signals
        yield
        return
    before = {number: signal.signal(number, handler) for number in _heard()}
    try:
        yield
    finally:
        for number, handler_before in before.items():
            signal.signal(number, handler_before)
