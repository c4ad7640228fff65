# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops a file on a program's window as a file manager does: the source's side of XDND
(freedesktop.org, "Drag-and-Drop Protocol for the X Window System", version 3)."""

from __future__ import annotations

import ctypes
import time
from pathlib import Path

from x_client import Client, Event, connected, window_of

VERSION = 3
SELECTION_REQUEST, SELECTION_NOTIFY = 30, 31  # event types, X11/X.h
CONTENT = "text/uri-list"
PATIENCE = 10.0  # seconds


class SelectionRequest(Event):
    """XSelectionRequestEvent of X11/Xlib.h."""

    _fields_ = (
        *((name, ctypes.c_ulong) for name in ("owner", "requestor", "selection", "target")),
        ("property", ctypes.c_ulong),
        ("time", ctypes.c_ulong),
        ("rest", ctypes.c_long * 24),
    )


class SelectionNotify(Event):
    """XSelectionEvent of X11/Xlib.h."""

    _fields_ = (
        *((name, ctypes.c_ulong) for name in ("requestor", "selection", "target", "property")),
        ("time", ctypes.c_ulong),
        ("rest", ctypes.c_long * 24),
    )


def drop_file(display_name: str, class_name: str, place: tuple[int, int], path: Path) -> None:
    """On the first visible window of a class, at a pixel of the screen, where the mouse must be.

    Raises RuntimeError if the program does not fetch the file's name.
    """
    with connected(display_name) as client:
        x11, display = client.x11, client.display
        target = window_of(display_name, class_name)
        x11.XDefaultRootWindow.restype = x11.XCreateSimpleWindow.restype = ctypes.c_ulong
        root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
        source = x11.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, *(ctypes.c_ulong(0),) * 2)
        selection = ctypes.c_ulong(client.atom("XdndSelection"))
        x11.XSetSelectionOwner(display, selection, ctypes.c_ulong(source), ctypes.c_ulong(0))
        client.send(target, "XdndEnter", source, VERSION << 24, client.atom(CONTENT), 0, 0)
        x, y = place
        copy = client.atom("XdndActionCopy")
        for _ in range(3):
            client.send(target, "XdndPosition", source, 0, x << 16 | y, 0, copy)
            time.sleep(0.2)
        client.send(target, "XdndDrop", source, 0, 0)
        _answer(client, f"{path.as_uri()}\r\n".encode())


def _answer(client: Client, content: bytes) -> None:
    """Tells the program what was dropped, once it asks."""
    x11, display = client.x11, client.display
    event = SelectionRequest()
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if not x11.XPending(display):
            time.sleep(0.02)
            continue
        x11.XNextEvent(display, ctypes.byref(event))
        if event.type != SELECTION_REQUEST:
            continue
        requestor, place = ctypes.c_ulong(event.requestor), ctypes.c_ulong(event.property)
        x11.XChangeProperty(
            *(display, requestor, place, ctypes.c_ulong(event.target), 8, 0),
            *(content, len(content)),
        )
        answer = SelectionNotify(SELECTION_NOTIFY)
        for name in ("requestor", "selection", "target", "property", "time"):
            setattr(answer, name, getattr(event, name))
        x11.XSendEvent(display, requestor, 0, ctypes.c_long(0), ctypes.byref(answer))
        x11.XSync(display, 0)
        time.sleep(0.5)  # it reads the name before this window is gone
        return
    raise RuntimeError("the program did not ask what was dropped")
