# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person corrects in a clip's take: kept with the clip in the .blend as JSON, so that undo
takes it back, and written into the take that a refinement or a capture makes."""

from __future__ import annotations

import json
import os

import bpy

from . import clips, native, scene_in, takes

_read: dict[str, tuple] = {}  # JSON that was read: its corrections
_board: tuple | None = None  # stamp of a take's file, its PinBoard


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


def frames_of(clip: bpy.types.MovieClip | None) -> list[int]:
    """Frames that are corrected; none where the JSON was edited and is no longer read."""
    try:
        return [entry.frame for entry in of_clip(clip)]
    except native.known_errors():
        return []


def board(context):
    """Where pins are put on the clip's take; raises what reading the take raises."""
    global _board
    take = scene_in.take(context)
    facts = os.stat(take.path)
    stamp = (take.path, facts.st_mtime_ns, facts.st_size)
    if _board is None or _board[0] != stamp:
        _board = (stamp, native.correcting().PinBoard(takes.load(take)))
    return _board[1]


def shown_board(context):
    """The same for drawing: None where there is no take that pins could be on."""
    take = takes.of_clip(context.scene, scene_in.clip_of(context))
    if take is None or not takes.find(take):
        return None
    try:
        return board(context)
    except native.known_errors():
        return None


def value_names(settings, context, text: str) -> list[str]:
    """What a value may be of, for a search."""
    there = shown_board(context)
    return native.correcting().value_names(there.performance) if there else []


def forget() -> None:
    global _board
    _board = None


def no_corrections(context) -> str:
    """Why nothing can be corrected."""
    return scene_in.no_clip(context) or scene_in.no_take(context, "capture it")
