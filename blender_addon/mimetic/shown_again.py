# SPDX-License-Identifier: GPL-3.0-or-later
"""Editors show again what an undo took from them and a redo brings back: clip editors their clip,
3D views in local view their objects. Of itself Blender leaves them empty, and shows all objects."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
from bpy.app.handlers import persistent

from . import editors, handlers

# By the address of an editor's space, which no undo touches: what it shows, as noted before an
# undo or a redo, and what it has lost because that is no longer there
_shown: dict[int, tuple[str, ...]] = {}
_lost: dict[int, tuple[str, ...]] = {}


def _clip_spaces() -> Iterator[bpy.types.SpaceClipEditor]:
    """Of all screens, on show or not."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            yield from (space for space in area.spaces if space.type == "CLIP_EDITOR")


def _isolated(layer: bpy.types.ViewLayer, space: bpy.types.SpaceView3D) -> tuple[str, ...]:
    if space.local_view is None or layer.depsgraph is None:
        return ()
    # An object itself knows it only where Blender has a window
    evaluated = ((obj, obj.evaluated_get(layer.depsgraph)) for obj in layer.objects)
    return tuple(obj.name for obj, shown in evaluated if shown.local_view_get(space))


def _are_there(blocks, names: tuple[str, ...]) -> bool:
    return all(name in blocks for name in names)


@persistent
def note(*_) -> None:
    """Before an undo or a redo."""
    _shown.clear()
    for space in _clip_spaces():
        _note(space, (space.clip.name,) if space.clip else (), bpy.data.movieclips)
    for window in bpy.context.window_manager.windows:
        layer = window.view_layer
        for area in window.screen.areas:
            space = area.spaces.active
            if area.type == "VIEW_3D":
                _note(space, _isolated(layer, space), layer.objects)


def _note(space, names: tuple[str, ...], blocks) -> None:
    address = space.as_pointer()
    if names:
        _shown[address] = names
    if names or _are_there(blocks, _lost.get(address, ())):
        _lost.pop(address, None)  # it came back on another way, and somebody chose what is shown


@persistent
def show(*_) -> None:
    """After it."""
    for space in _clip_spaces():
        names = () if space.clip else _found_again(space, bpy.data.movieclips)
        if names:
            space.clip = bpy.data.movieclips[names[0]]
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            space = area.spaces.active
            shows_all = area.type == "VIEW_3D" and space.local_view is None
            names = _found_again(space, window.view_layer.objects) if shows_all else ()
            if names:
                _isolate(window, area, names)


def _found_again(space, blocks) -> tuple[str, ...]:
    """What an editor that shows nothing now has lost, if all of it is there again."""
    address = space.as_pointer()
    if not _are_there(blocks, _shown.get(address, ())):
        _lost[address] = _shown[address]
    if address in _lost and _are_there(blocks, _lost[address]):
        return _lost.pop(address)
    return ()


def _isolate(window, area, names: tuple[str, ...]) -> None:
    """Local view takes what is selected, which is as it was afterwards."""
    objects, view = window.view_layer.objects, area.spaces.active.region_3d
    before, perspective = [o for o in objects if o.select_get()], view.view_perspective
    for obj in objects:
        obj.select_set(obj.name in names)
    editors.toggle_local_view(window, area)
    view.view_perspective = perspective
    for obj in objects:
        obj.select_set(obj in before)


@persistent
def forget(*_) -> None:
    """Another file is open, with editors of its own."""
    _shown.clear()
    _lost.clear()


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
    forget()
