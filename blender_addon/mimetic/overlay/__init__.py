# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles and skin strain drawn over faces in the 3D view; switched on by the scene's settings.

The drawing is never part of the face: switched off, nothing of it is left.
"""

import bpy
from bpy.app.handlers import persistent

from . import drawing, live

_drawn = []  # handles of Blender's draw callbacks


@persistent
def forget_all(*_) -> None:
    """Another file: what was known belongs to faces that are gone."""
    live.forget()


@persistent
def notice_changes(scene, depsgraph) -> None:
    """Sculpted shape keys change the face without any slider moving."""
    for update in depsgraph.updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            live.mark_changed(update.id.name)


HANDLERS = (
    (bpy.app.handlers.load_post, forget_all),
    (bpy.app.handlers.undo_post, forget_all),
    (bpy.app.handlers.redo_post, forget_all),
    (bpy.app.handlers.depsgraph_update_post, notice_changes),
)


def register() -> None:
    add = bpy.types.SpaceView3D.draw_handler_add
    _drawn.append(add(drawing.draw_faces, (), "WINDOW", "POST_VIEW"))
    _drawn.append(add(drawing.draw_legend, (), "WINDOW", "POST_PIXEL"))
    for handlers, handler in HANDLERS:
        handlers.append(handler)


def unregister() -> None:
    for handlers, handler in HANDLERS:
        handlers.remove(handler)
    while _drawn:
        bpy.types.SpaceView3D.draw_handler_remove(_drawn.pop(), "WINDOW")
    live.forget()
