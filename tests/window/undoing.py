# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: each step is taken back and brought again by the screen's own keys,
and all that the add-on writes is compared, as it stands and without a frame that is set for it."""

from __future__ import annotations

import importlib

import bpy
from scene_state import assert_same, written_into
from walk import Steps, Walk, area_of

PACKAGE = "bl_ext.user_default.mimetic"
PATIENCE = 30  # seconds, for Blender to read the document of an undo step
LOOK = 0.3  # seconds between two looks at what is to be at rest
# Blender's own, which no undo takes back
APART = {"all_ids", "screens", "workspaces", "window_managers", "libraries", "brushes", "palettes"}


def module(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def document() -> dict:
    """All that a step may change in the .blend, and what comes next."""
    scene = bpy.context.scene
    written = written_into(scene, module)
    written["frame"] = scene.frame_current
    for name in dir(bpy.data):
        blocks = getattr(bpy.data, name)
        if isinstance(blocks, bpy.types.bpy_prop_collection) and name not in APART:
            written[f"all {name}"] = sorted(block.name for block in blocks)
    window = bpy.context.window_manager.windows[0]
    clip_editor = next((a for a in window.screen.areas if a.type == "CLIP_EDITOR"), None)
    with bpy.context.temp_override(window=window, area=clip_editor or area_of("VIEW_3D")[1]):
        written["next step"] = module("next_step").of(bpy.context).text
    return written


def editors() -> dict:
    """What the editors show of the document, which Blender's undo leaves to them."""
    window, shown = bpy.context.window_manager.windows[0], {}
    for area in window.screen.areas:
        space, name = area.spaces.active, f"{area.type} at {area.x}, {area.y}"
        if area.type == "CLIP_EDITOR":
            shown[name] = space.clip.name if space.clip else "no clip"
        elif area.type == "VIEW_3D":
            camera = space.camera.name if space.camera else "no camera"
            objects = [
                o.name for o in bpy.context.scene.objects if o.visible_in_viewport_get(space)
            ]
            shown[name] = [space.region_3d.view_perspective, camera, *sorted(objects)]
    return shown


def views() -> dict:
    """How 3D views look: through what, alone or with all objects, in what shading."""
    shown = {}
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type != "VIEW_3D":
            continue
        space = area.spaces.active
        view, shading = space.region_3d, space.shading
        looks = [view.view_perspective, space.local_view is not None, shading.type]
        looks += [shading.light, shading.color_type, shading.show_cavity]
        if view.view_perspective != "CAMERA":
            looks += [round(one, 3) for one in (*view.view_rotation, view.view_distance)]
        shown[f"view at {area.x}, {area.y}"] = looks
    return shown


def difference(before: dict, after: dict) -> str:
    """Where the first one is, and what only one of them has; or nothing."""
    try:
        assert_same(before, after)
    except AssertionError as error:
        lacking = sorted(before.keys() ^ after.keys())
        return " ".join(f"differs in {error} {lacking}".split())[:400]
    return ""


def at_rest(walk: Walk, name: str) -> Steps:
    """Waits until nothing changes any more; returns the document."""
    last = document()
    yield LOOK

    def is_same() -> bool:
        nonlocal last
        earlier, last = last, document()
        return not difference(earlier, last)

    yield from walk.until(is_same, PATIENCE, f"{name} comes to rest")
    return last


def on_screen(x: float, y: float) -> tuple[int, int]:
    """From the window's bottom left to the screen's top left, whose window it fills."""
    return round(x), bpy.context.window_manager.windows[0].height - 1 - round(y)


def press(walk: Walk, name: str, kind: str, key: str) -> Steps:
    """Presses a real key with the real mouse over the main part of an editor."""
    region = next(region for region in area_of(kind)[1].regions if region.type == "WINDOW")
    x, y = on_screen(region.x + region.width // 3, region.y + region.height // 2)
    yield from walk.ask(f"{name}.act", f"mousemove {x} {y} sleep 0.2 key {key}")


def becomes(walk: Walk, wanted: dict, claim: str) -> Steps:
    """The document is as it was, and stays so while it is photographed."""
    found = ""

    def is_same() -> bool:
        nonlocal found
        found = difference(wanted, document())
        return not found

    yield from walk.until(is_same, PATIENCE, claim, lambda: found)


def undo(
    walk: Walk, name: str, before: dict, kind: str = "VIEW_3D", looks: dict | None = None
) -> Steps:
    """looks: of 3D views, before the step."""
    yield from press(walk, f"{name}-undo", kind, "ctrl+z")
    yield from becomes(walk, before, f"undo leaves nothing of {name}")
    yield from walk.picture(f"{name}-undone")
    found = difference(before, document())
    walk.check(f"and nothing of {name} comes back by itself", not found, found)
    if looks is not None:
        found = difference(looks, views())
        walk.check(f"3D views look as they did before {name}", not found, found)


def redo(walk: Walk, name: str, after: dict, shown: dict, kind: str = "VIEW_3D") -> Steps:
    """shown: what editors showed after the step."""
    yield from press(walk, f"{name}-redo", kind, "ctrl+shift+z")
    yield from becomes(walk, after, f"redo brings {name} back")
    yield from walk.picture(f"{name}-redone")
    found = difference(after, document())
    walk.check(f"and all of {name} stays", not found, found)
    found = difference(shown, editors())
    walk.check(f"editors show what they did after {name}", not found, found)


def undo_and_redo(
    walk: Walk, name: str, before: dict, kind: str = "VIEW_3D", looks: dict | None = None
) -> Steps:
    """Of the step that was done last; before: the document without it; looks: of 3D views then."""
    after = yield from at_rest(walk, name)
    walk.check(f"{name} changes the document", difference(before, after))
    shown, turned = editors(), views()
    yield from walk.picture(f"{name}-done")
    yield from undo(walk, name, before, kind, looks)
    yield from redo(walk, name, after, shown, kind)
    found = difference(turned, views())
    walk.check(f"3D views look as they did after {name}", not found, found)
