# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person corrects in a clip's take: kept with the clip in the .blend as JSON, so that undo
takes it back, and written into the take that a refinement or a capture makes."""

from __future__ import annotations

import json

import bpy

from . import clips, native, scene_in, shown_take

_read: dict[str, tuple] = {}  # JSON that was read: its corrections
_board = None  # the PinBoard of the take that was read last


def of_clip(clip: bpy.types.MovieClip | None) -> tuple:
    """The clip's corrections, by frame; raises InvalidInput if the JSON was edited and is none."""
    record = clips.find(clip) if clip else None
    text = record.corrections if record else ""
    if not text:
        return ()
    if text not in _read:
        _read.clear()
        _read[text] = native.correcting().corrections_in(text)
    return _read[text]


def keep(clip: bpy.types.MovieClip, corrections: tuple) -> None:
    record = clips.ensure(clip)
    document = native.correcting().as_document(corrections)
    record.corrections = json.dumps(document) if corrections else ""


def readable(clip: bpy.types.MovieClip | None) -> tuple:
    """The same for drawing: none where the JSON was edited and is no longer read."""
    try:
        return of_clip(clip)
    except native.known_errors():
        return ()


def frames_of(clip: bpy.types.MovieClip | None) -> list[int]:
    return [entry.frame for entry in readable(clip)]


def board(context):
    """Where pins are put on the clip's take; raises what reading the take raises."""
    global _board
    performance = shown_take.performance(context)
    if _board is None or _board.performance is not performance:
        _board = native.correcting().PinBoard(performance)
    return _board


def value_names(settings, context, text: str) -> list[str]:
    """What a value may be of, for a search."""
    performance = shown_take.performance_or_none(context)
    return native.correcting().value_names(performance) if performance else []


def forget() -> None:
    global _board
    _board = None


def no_corrections(context) -> str:
    """Why nothing can be corrected."""
    return scene_in.no_clip(context) or scene_in.no_take(context, "Capture")
