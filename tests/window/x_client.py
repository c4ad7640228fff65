# SPDX-License-Identifier: GPL-3.0-or-later
"""A connection to an X display by Xlib, as far as the window tests talk to a program's windows."""

from __future__ import annotations

import contextlib
import ctypes
import ctypes.util
import subprocess
from collections.abc import Iterator

CLIENT_MESSAGE = 33  # event type, X11/X.h


class Event(ctypes.Structure):
    """What all events of X11/Xlib.h begin with; an XEvent is as large as 24 longs."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
    )


class ClientMessage(Event):
    """XClientMessageEvent of X11/Xlib.h."""

    _fields_ = (
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * 24),
    )


class Client:
    """The open display and its library."""

    def __init__(self, display_name: str) -> None:
        self.x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
        self.x11.XOpenDisplay.restype = ctypes.c_void_p
        self.x11.XInternAtom.restype = ctypes.c_ulong
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(display_name.encode()))
        if not self.display:
            raise RuntimeError(f"the display {display_name} cannot be opened")

    def atom(self, name: str) -> int:
        return self.x11.XInternAtom(self.display, name.encode(), 0)

    def send(self, window: int, message: str, *data: int) -> None:
        """A message of 32-bit numbers to a program's window; raises RuntimeError."""
        event = ClientMessage(CLIENT_MESSAGE, window=window, format=32)
        event.message_type = self.atom(message)
        for i, value in enumerate(data):
            event.data[i] = value
        to = ctypes.c_ulong(window)
        if not self.x11.XSendEvent(self.display, to, 0, ctypes.c_long(0), ctypes.byref(event)):
            raise RuntimeError(f"{message} was not sent")
        self.x11.XFlush(self.display)


@contextlib.contextmanager
def connected(display_name: str) -> Iterator[Client]:
    client = Client(display_name)
    try:
        yield client
    finally:
        client.x11.XCloseDisplay(client.display)


def window_of(display_name: str, class_name: str) -> int:
    """The first visible window of a class, on a display such as `:1`."""
    search = ["xdotool", "search", "--onlyvisible", "--class", class_name]
    found = subprocess.run(
        ["env", f"DISPLAY={display_name}", *search], check=True, stdout=subprocess.PIPE, timeout=30
    )
    return int(found.stdout.split()[0])
