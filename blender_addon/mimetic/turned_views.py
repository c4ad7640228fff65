# SPDX-License-Identifier: GPL-3.0-or-later
"""3D views that a bake turned to the camera turn back with its undo, and again with its redo.

Editors are not of the document, so Blender's undo leaves them as they are. The document counts the
turns, which tells of an undo or a redo what it went over.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
from bpy.app.handlers import persistent

from . import editors, handlers

CAVITIES = ("show_cavity", "cavity_type", "cavity_ridge_factor", "curvature_ridge_factor")
SHADING = ("light", "color_type", *CAVITIES)
PLACE = (
    "view_rotation",
    "view_location",
    "view_distance",
)  # the camera's while it is looked through


@dataclass(frozen=True)
class Look:
    """Of a 3D view."""

    perspective: str
    place: tuple
    shading: tuple
    is_local: bool


@dataclass(frozen=True)
class Turn:
    """Looks before and after, by the address of the view's space, which no undo touches."""

    previous: int  # number of the turn before it
    before: dict[int, Look]
    after: dict[int, Look]


_turns: dict[int, Turn] = {}
_number = 0  # of the document's last turn before an undo or a redo


def _views() -> Iterator[tuple[bpy.types.Window, bpy.types.Area]]:
    for window in bpy.context.window_manager.windows:
        yield from ((window, area) for area in window.screen.areas if area.type == "VIEW_3D")


def _look(space: bpy.types.SpaceView3D) -> Look:
    view, shading = space.region_3d, space.shading
    place = view.view_rotation.copy(), view.view_location.copy(), view.view_distance
    chosen = tuple(getattr(shading, name) for name in SHADING)
    return Look(view.view_perspective, place, chosen, space.local_view is not None)


def _looks() -> dict[int, Look]:
    spaces = (area.spaces.active for _, area in _views())
    return {space.as_pointer(): _look(space) for space in spaces}


@contextmanager
def turning(scene: bpy.types.Scene) -> Iterator[None]:
    """Around what turns views for a step that can be undone."""
    before = _looks()
    yield
    after = _looks()
    if after != before:
        previous = scene.mimetic.num_turns
        scene.mimetic.num_turns = max((previous, *_turns)) + 1
        _turns[scene.mimetic.num_turns] = Turn(previous, before, after)


@persistent
def note(*_) -> None:
    """Before an undo or a redo."""
    global _number
    _number = bpy.context.scene.mimetic.num_turns


@persistent
def turn_back(*_) -> None:
    """After an undo, which may go over several turns."""
    number, now = _number, bpy.context.scene.mimetic.num_turns
    while number > now and number in _turns:
        _give(_turns[number].after, _turns[number].before)
        number = _turns[number].previous


@persistent
def turn_again(*_) -> None:
    """After a redo."""
    now = bpy.context.scene.mimetic.num_turns
    if now > _number and now in _turns:
        _give(_turns[now].before, _turns[now].after)


def _give(had: dict[int, Look], wanted: dict[int, Look]) -> None:
    """What of a view was changed by hand since then stays."""
    for window, area in _views():
        space = area.spaces.active
        address = space.as_pointer()
        if address in had and address in wanted:
            _turn(window, area, had[address], wanted[address])


def _turn(window: bpy.types.Window, area: bpy.types.Area, had: Look, wanted: Look) -> None:
    space = area.spaces.active
    view, shading = space.region_3d, space.shading
    if had.is_local and not wanted.is_local and space.local_view is not None:
        editors.toggle_local_view(window, area)
    if view.view_perspective in {had.perspective, wanted.perspective}:
        view.view_perspective = wanted.perspective
        if wanted.perspective != "CAMERA":
            for name, value in zip(PLACE, wanted.place, strict=True):
                setattr(view, name, value)
    for name, before, after in zip(SHADING, had.shading, wanted.shading, strict=True):
        if getattr(shading, name) == before:
            setattr(shading, name, after)


@persistent
def forget(*_) -> None:
    """Another file is open, which counts for itself."""
    _turns.clear()


HANDLERS = (
    (bpy.app.handlers.undo_pre, note),
    (bpy.app.handlers.redo_pre, note),
    (bpy.app.handlers.undo_post, turn_back),
    (bpy.app.handlers.redo_post, turn_again),
    (bpy.app.handlers.load_post, forget),
)


def register() -> None:
    handlers.add(HANDLERS)


def unregister() -> None:
    handlers.remove(HANDLERS)
    forget()
