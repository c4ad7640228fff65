# SPDX-License-Identifier: GPL-3.0-or-later
"""Editors that are open in any window."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

TIME = ("DOPESHEET_EDITOR", "GRAPH_EDITOR")  # whose width is the scene's time
OF_TAKES = ("CLIP_EDITOR", *TIME)  # that draw how captured frames are
# Blender's operators that go with the mouse, gizmos, and macros that end in one
DRAGS = ("TRANSFORM_OT_", "GIZMOGROUP_OT_", "OBJECT_OT_")


def open_editors(*kinds: str) -> Iterator[bpy.types.Area]:
    """Areas of these types, such as CLIP_EDITOR; of all types if none is given."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if not kinds or area.type in kinds:
                yield area


def is_dragging() -> bool:
    """Whether something goes with the mouse in any window: is moved, turned, scaled."""
    return any(
        operator.bl_idname.startswith(DRAGS)
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )


def toggle_local_view(window: bpy.types.Window, area: bpy.types.Area) -> None:
    """Has a 3D view show what is selected alone, or all again; where it looks stays."""
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview(frame_selected=False)


def redraw_parts(part: str, *kinds: str) -> None:
    """One part of these editors, UI for the sidebar: a 3D view takes long to draw."""
    for area in open_editors(*kinds):
        for region in area.regions:
            if region.type == part:
                region.tag_redraw()


def redraw(*kinds: str) -> None:
    """Has these editors drawn anew: Blender draws them only after events of their own."""
    for area in open_editors(*kinds):
        area.tag_redraw()
