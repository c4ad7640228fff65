# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks a program's window on an X display to close, as its close button does through the window
manager, of which a screen without a monitor has none."""

from __future__ import annotations

import ctypes
import ctypes.util
import subprocess

CLIENT_MESSAGE = 33  # event type, X11/X.h


class ClientMessage(ctypes.Structure):
    """XClientMessageEvent of X11/Xlib.h; an XEvent is as large as 24 longs."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * 24),
    )


def ask_to_close(display_name: str, class_name: str) -> None:
    """The first visible window of a class, on a display such as `:1`, is sent WM_DELETE_WINDOW."""
    search = ["xdotool", "search", "--onlyvisible", "--class", class_name]
    found = subprocess.run(
        ["env", f"DISPLAY={display_name}", *search], check=True, stdout=subprocess.PIPE, timeout=30
    )
    window = int(found.stdout.split()[0])
    x11, display, atoms = _opened(display_name)
    event = ClientMessage(CLIENT_MESSAGE, window=window, message_type=atoms[0], format=32)
    event.data[0] = atoms[1]
    sent = x11.XSendEvent(display, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(event))
    x11.XCloseDisplay(display)
    if not sent:
        raise RuntimeError("the window was not asked to close")


def make_known(display_name: str) -> None:
    """A display with a window manager knows the message, and Blender asks at its start for the
    message's number only if it is known. The display must not forget it (`-noreset`)."""
    x11, display, _ = _opened(display_name)
    x11.XCloseDisplay(display)


def _opened(display_name: str) -> tuple[ctypes.CDLL, ctypes.c_void_p, list[int]]:
    """The library, the open display, and the numbers of the message and of what it asks."""
    x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(display_name.encode()))
    if not display:
        raise RuntimeError(f"the display {display_name} cannot be opened")
    names = (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW")
    return x11, display, [x11.XInternAtom(display, name, 0) for name in names]
