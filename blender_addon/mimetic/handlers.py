# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls on what happens, put on its lists and taken off again."""

from collections.abc import Callable, Sequence
from typing import Any

# Lists of bpy.app.handlers, each with a function of the extension's that belongs on it
Handlers = Sequence[tuple[list[Callable[..., Any]], Callable[..., Any]]]


def add(pairs: Handlers) -> None:
    for called, handler in pairs:
        called.append(handler)


def remove(pairs: Handlers) -> None:
    """Those that are on them: others may have emptied a list, and not all are put on each."""
    for called, handler in pairs:
        if handler in called:
            called.remove(handler)
