# SPDX-License-Identifier: GPL-3.0-or-later
"""The workspace Mimetic: footage left, the face through the camera right, curves below.

It begins as a workspace that Blender ships, so that nothing of the user's is touched. Blender shows
another workspace only after an event, and an area that is cut in the same tick in which its screen
came up, or that is given another editor in the tick in which it was cut, takes Blender down: each
step has a tick of its own.
"""

from __future__ import annotations

import os
from collections.abc import Generator

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import editors, native
from .scene_out import opened_view

NAME = "Mimetic"
TAB = "Mimetic"
MADE = "mimetic_made"  # property of the workspace that we made, whatever its name is by now
SHIPPED = ("VFX", "Rendering")  # Blender's template, and the workspace in it
LARGE = "IMAGE_EDITOR"  # the area of that one which takes most of the screen
BELOW, LEFT = 0.32, 0.5  # of the height for curves, of the width for footage
TICK = 0.1  # seconds
PATIENCE = 50  # ticks until it is on show
Steps = Generator[None, None, None]


def find() -> bpy.types.WorkSpace | None:
    return next((one for one in bpy.data.workspaces if one.get(MADE)), None)


def no_workspace() -> str:
    """Why it cannot be opened."""
    if bpy.app.background:
        return "Workspaces are for Blender's window"
    if find() is None and _shipped_file() is None:
        return iface_("The template {name}, which Blender ships, is missing").format(
            name=SHIPPED[0]
        )
    return ""


def open_in(window: bpy.types.Window) -> None:
    """Shows it, and makes it first where there is none; it is complete after some ticks."""
    global _steps
    own = find()
    if own is not None:
        window.workspace = own
        return
    before = set(bpy.data.workspaces)
    with bpy.context.temp_override(window=window):
        bpy.ops.workspace.append_activate(idname=SHIPPED[1], filepath=_shipped_file())
    own = next(one for one in bpy.data.workspaces if one not in before)
    own.name = NAME
    own[MADE] = True
    _steps = _arrange(window.as_pointer(), own.as_pointer())
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=TICK)


def show_footage(context) -> None:
    """Opens it where no clip editor shows what was loaded or found."""
    is_shown = any(editors.open_editors("CLIP_EDITOR"))
    if context.window is not None and not is_shown and not no_workspace():
        open_in(context.window)


_steps: Steps | None = None  # of one that is being arranged


def _tick() -> float | None:
    global _steps
    try:
        if _steps is not None:
            next(_steps)
            return TICK
    except StopIteration:
        _steps = None
    except BaseException:
        _steps = None
        raise
    return None


def _shipped_file() -> str | None:
    for folder in bpy.utils.app_template_paths(path=SHIPPED[0]):
        path = os.path.join(folder, "startup.blend")
        if os.path.isfile(path):
            return path
    return None


def _arrange(window_pointer: int, workspace_pointer: int) -> Steps:
    """References to Blender's data do not last over a tick: it is looked up in each."""

    def window() -> bpy.types.Window | None:
        windows = bpy.context.window_manager.windows
        shown = next((one for one in windows if one.as_pointer() == window_pointer), None)
        is_there = shown and shown.workspace.as_pointer() == workspace_pointer
        return shown if is_there else None

    for _ in range(PATIENCE):
        yield
        if window():
            break
    yield
    for direction, share in (("HORIZONTAL", BELOW), ("VERTICAL", LEFT)):
        if (shown := window()) is None:
            return  # it was left again
        area = max(_large(shown), key=lambda one: one.y)
        with bpy.context.temp_override(window=shown, area=area):
            bpy.ops.screen.area_split(direction=direction, factor=share)
        yield
    if (shown := window()) is None:
        return
    below, *above = sorted(_large(shown), key=lambda one: one.y)
    left, right = sorted(above, key=lambda one: one.x)
    below.type, left.type, right.type = "GRAPH_EDITOR", "CLIP_EDITOR", "VIEW_3D"
    yield
    if shown := window():
        _show(shown)
    yield  # regions are drawn: only then has the sidebar its tabs, and the footage its place
    yield
    if shown := window():
        _fit(shown)


def _large(window: bpy.types.Window) -> list[bpy.types.Area]:
    return [area for area in window.screen.areas if area.type == LARGE]


def _show(window: bpy.types.Window) -> None:
    """The scene's footage with the sidebar, its camera, the curves."""
    scene = window.scene
    for area in window.screen.areas:
        space = area.spaces.active
        if area.type == "CLIP_EDITOR":
            space.mode = "TRACKING"
            space.clip = scene.mimetic.clip
            space.show_region_toolbar = False
            space.show_region_ui = True
        elif area.type == "VIEW_3D":
            space.region_3d.view_camera_zoom = opened_view.FULL_ZOOM
            if scene.camera is not None and scene.camera == scene.mimetic.camera:
                space.region_3d.view_perspective = "CAMERA"
                opened_view.show_textures(space.shading)
        elif area.type == "GRAPH_EDITOR":
            space.use_normalization = True
            space.show_region_ui = False


def _fit(window: bpy.types.Window) -> None:
    """The whole picture, and our tab in front."""
    area = next((one for one in window.screen.areas if one.type == "CLIP_EDITOR"), None)
    regions = {one.type: one for one in area.regions} if area else {}
    if not regions or native.problem():
        return
    if regions["UI"].width > 1:  # it has been drawn
        regions["UI"].active_panel_category = TAB
    if area.spaces.active.clip is not None:
        with bpy.context.temp_override(window=window, area=area, region=regions["WINDOW"]):
            bpy.ops.clip.view_all(fit_view=True)


def register() -> None:
    """Nothing is made before it is asked for."""


def unregister() -> None:
    global _steps
    _steps = None
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
