# SPDX-License-Identifier: GPL-3.0-or-later
"""Clip editors show a clip again that an undo took from them and a redo brings back: of itself
Blender leaves them empty."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
from bpy.app.handlers import persistent

from . import handlers

_shown: dict[int, str] = {}  # clip editor, by its address: the clip that it shows, or showed last


def _spaces() -> Iterator[bpy.types.SpaceClipEditor]:
    """Of all screens, on show or not; no undo touches them."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            for space in area.spaces:
                if space.type == "CLIP_EDITOR":
                    yield space


@persistent
def note(*_) -> None:
    """Before an undo or a redo."""
    for space in _spaces():
        if space.clip is not None:
            _shown[space.as_pointer()] = space.clip.name
        elif _shown.get(space.as_pointer(), "") in bpy.data.movieclips:
            del _shown[space.as_pointer()]  # somebody has emptied it


@persistent
def show(*_) -> None:
    """After it."""
    for space in _spaces():
        clip = bpy.data.movieclips.get(_shown.get(space.as_pointer(), ""))
        if space.clip is None and clip is not None:
            space.clip = clip


@persistent
def forget(*_) -> None:
    """Another file is open, with editors of its own."""
    _shown.clear()


HANDLERS = (
    (bpy.app.handlers.undo_pre, note),
    (bpy.app.handlers.redo_pre, note),
    (bpy.app.handlers.undo_post, show),
    (bpy.app.handlers.redo_post, show),
    (bpy.app.handlers.load_post, forget),
)


def register() -> None:
    handlers.add(HANDLERS)


def unregister() -> None:
    handlers.remove(HANDLERS)
    _shown.clear()
