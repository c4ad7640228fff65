# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks a program's window on an X display to close, as its close button does through the window
manager, of which a screen without a monitor has none."""

from __future__ import annotations

from x_client import connected, window_of

PROTOCOLS, CLOSE = "WM_PROTOCOLS", "WM_DELETE_WINDOW"


def ask_to_close(display_name: str, class_name: str) -> None:
    """The first visible window of a class, on a display such as `:1`, is sent WM_DELETE_WINDOW."""
    with connected(display_name) as client:
        client.send(window_of(display_name, class_name), PROTOCOLS, client.atom(CLOSE))


def make_known(display_name: str) -> None:
    """A display with a window manager knows the message, and Blender asks at its start for the
    message's number only if it is known. The display must not forget it (`-noreset`)."""
    with connected(display_name) as client:
        for name in (PROTOCOLS, CLOSE):
            client.atom(name)
