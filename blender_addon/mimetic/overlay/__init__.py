# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over faces: muscles and strain in the 3D view, fit and take in the clip editor, how
good the take is along the time, and how far its curves may be off.

The drawing is never part of the face: switched off, nothing of it is left.
"""

import bpy
from bpy.app.handlers import persistent

from .. import baked_errors, corrections, handlers, shown_take
from . import captured, drawing, error_bars, fitted, live, picture, seen, timeline

_handles = []  # handles of Blender's draw callbacks


@persistent
def forget_all(*_) -> None:
    """Another file is open: what is cached is of faces that no longer exist."""
    live.forget()
    forget_takes()


def forget_takes() -> None:
    seen.forget()
    baked_errors.forget()
    error_bars.forget()
    corrections.forget()
    shown_take.forget()


@persistent
def notice_changes(scene, depsgraph) -> None:
    """Sculpted shape keys change the face without any slider moving."""
    for update in depsgraph.updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            live.mark_changed(update.id.name)


def draw_clip() -> None:
    """The take over its footage, or the fit where there is none."""
    context = bpy.context
    if picture.has_place(context) and not captured.draw_capture(context):
        fitted.draw_fit(context)


HANDLERS = (
    (bpy.app.handlers.load_post, forget_all),
    (bpy.app.handlers.undo_post, forget_all),
    (bpy.app.handlers.redo_post, forget_all),
    (bpy.app.handlers.depsgraph_update_post, notice_changes),
)


def register() -> None:
    for space, draw, kind in (
        (bpy.types.SpaceView3D, drawing.draw_faces, "POST_VIEW"),
        (bpy.types.SpaceView3D, drawing.draw_legend, "POST_PIXEL"),
        (bpy.types.SpaceClipEditor, draw_clip, "POST_PIXEL"),
        (bpy.types.SpaceDopeSheetEditor, timeline.draw_strip, "POST_PIXEL"),
        (bpy.types.SpaceGraphEditor, timeline.draw_strip, "POST_PIXEL"),
        (bpy.types.SpaceGraphEditor, error_bars.draw_bands, "POST_PIXEL"),
    ):
        _handles.append((space, space.draw_handler_add(draw, (), "WINDOW", kind)))
    handlers.add(HANDLERS)


def unregister() -> None:
    handlers.remove(HANDLERS)
    while _handles:
        space, handle = _handles.pop()
        space.draw_handler_remove(handle, "WINDOW")
    live.forget()
    fitted.forget()
    forget_takes()
