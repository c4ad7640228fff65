# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance shown on a character's own controls at the scene's frame, as their table has it.

Nothing is keyed. What the character had before is kept at the object, so that an undo or a file
that was saved meanwhile brings nothing of it back.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field

import bpy
from bpy.app.handlers import persistent

from . import control_rows, handlers, native
from .scene_out import control_values, face_bones, own_keys


@dataclass
class Shown:
    """The character on show, by name: an undo may replace the object."""

    name: str
    preview: object  # mimetic.retarget.playing.ControlPreview
    channels: list = field(default_factory=list)  # of a rig's face
    others: list[str] = field(default_factory=list)  # names of its teeth and eyes
    rows: list | None = None  # of the table, as they were last read; None after a change
    is_quiet: bool = False  # rows are being written


active: Shown | None = None


def begin(character: bpy.types.Object, preview) -> None:
    """Shows a character; one that was on show before is put back."""
    global active
    end()
    is_rig = character.type == "ARMATURE"
    channels = face_bones.channels(character) if is_rig else []
    others = [] if is_rig else [obj.name for obj, _ in own_keys.holders(character)[1:]]
    active = Shown(character.name, preview, channels, others)
    _show()


def end() -> None:
    """Puts the character back as it was before."""
    global active
    active = None
    _put_back_all()


def is_of(character: bpy.types.Object | None) -> bool:
    return active is not None and character is not None and character.name == active.name


def is_moving(head: bpy.types.Object) -> bool:
    """Whether the character on show is a head, or the rig that moves it."""
    if active is None:
        return False
    carriers = {head.parent, *(m.object for m in head.modifiers if m.type == "ARMATURE")}
    return active.name in {obj.name for obj in (head, *carriers) if obj is not None}


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """While many rows change: what they come to is shown once."""
    if active is None:
        yield
        return
    active.is_quiet = True
    try:
        yield
    finally:
        active.is_quiet = False
        _show_changed()


def row_changed(character: bpy.types.Object) -> None:
    """A row of the table has another value."""
    if is_of(character):
        _show_changed()


def _show_changed() -> None:
    if active is not None:
        active.rows = None
    _show()


def _show() -> None:
    if active is None or active.is_quiet:
        return
    character = bpy.data.objects.get(active.name)
    if character is None or (character.type == "MESH" and character.data.shape_keys is None):
        end()
        return
    scene = bpy.context.scene
    try:
        if active.rows is None:
            active.rows = control_rows.rows_of(character)
        values = active.preview.values(scene.frame_current_final, active.rows)
    except native.known_errors():  # with these rows there is nothing to go by
        values = {}
    off = {row.control for row in active.rows or ()} - values.keys()
    others = [obj for name in active.others if (obj := bpy.data.objects.get(name))]
    for obj in (character, *others):
        if obj.type == "ARMATURE" or obj.data.shape_keys is not None:
            _put(obj, values, off)


def _put(obj: bpy.types.Object, values: dict[str, float], off: set[str]) -> None:
    """off: controls that were switched off, which are as they were before."""
    settings = obj.mimetic
    if not settings.before_preview:
        settings.before_preview = json.dumps(control_values.now(obj))
    before = json.loads(settings.before_preview)
    is_rig = obj.type == "ARMATURE"
    control_values.put_back(obj, {n: v for n, v in before.items() if is_rig or n in off})
    control_values.put(obj, values, active.channels)


def _put_back_all() -> None:
    for character in bpy.data.objects:
        if character.mimetic.before_preview and character.library is None:
            control_values.put_back(character, json.loads(character.mimetic.before_preview))
            character.mimetic.before_preview = ""


@persistent
def _follow(*_) -> None:
    _show()


@persistent
def _after_undo(*_) -> None:
    """Undo brings values back that were on show, too."""
    if active is None:
        _put_back_all()
    else:
        _show_changed()


@persistent
def _before_save(*_) -> None:
    """A file holds the character as it was before."""
    _put_back_all()


@persistent
def _forget(*_) -> None:
    """Another file is open."""
    global active
    active = None


HANDLERS = (
    (bpy.app.handlers.frame_change_post, _follow),
    (bpy.app.handlers.undo_post, _after_undo),
    (bpy.app.handlers.redo_post, _after_undo),
    (bpy.app.handlers.save_pre, _before_save),
    (bpy.app.handlers.save_post, _follow),
    (bpy.app.handlers.save_post_fail, _follow),
    (bpy.app.handlers.load_pre, _forget),
)


def register() -> None:
    control_rows.changed = row_changed
    handlers.add(HANDLERS)


def unregister() -> None:
    end()
    control_rows.changed = None
    handlers.remove(HANDLERS)
