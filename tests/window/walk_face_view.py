# SPDX-License-Identifier: GPL-3.0-or-later
"""A dropped clip opens the workspace; the baked face over its footage, as lines, rendered."""

import importlib
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, override, press, start

PACKAGE = "bl_ext.user_default.mimetic"
SAMPLES = 8  # of EEVEE, which takes 64 unless told: seconds each where a processor draws


def layouts() -> dict[str, list]:
    """Of the user's own workspaces: each area's editor and place."""
    return {
        workspace.name: [
            [(area.type, area.x, area.y, area.width, area.height) for area in screen.areas]
            for screen in workspace.screens
        ]
        for workspace in bpy.data.workspaces
        if "mimetic_made" not in workspace
    }


def shown() -> bpy.types.WorkSpace:
    return bpy.context.window_manager.windows[0].workspace


def is_complete() -> bool:
    kinds = {area.type for area in shown().screens[0].areas}
    return {"CLIP_EDITOR", "VIEW_3D", "GRAPH_EDITOR"} <= kinds


def drop_a_clip(walk: Walk) -> Steps:
    before, scenes = layouts(), len(bpy.data.scenes)
    first = shown().name
    invoke("VIEW_3D", bpy.ops.mimetic.load_clip, filepath=str(walk.folder / walk.settings["clip"]))
    yield from walk.until(is_complete, 20, "the workspace comes with the clip")
    yield 1.0
    walk.check("it is called Mimetic", shown().name == "Mimetic", shown().name)
    left, right = area_of("CLIP_EDITOR")[1], area_of("VIEW_3D")[1]
    below = area_of("GRAPH_EDITOR")[1]
    walk.check("footage left, face right", left.x < right.x and left.y == right.y)
    walk.check("curves below", below.y < left.y)
    clip = bpy.context.scene.mimetic.clip
    walk.check("the clip is on show", clip is not None and left.spaces.active.clip == clip)
    sidebar = next(region for region in left.regions if region.type == "UI")

    def is_in_front() -> bool:  # once it has been drawn
        return getattr(sidebar, "active_panel_category", "") == "Mimetic"

    yield from walk.until(is_in_front, 20, "the tab is in front")
    walk.check("the user's workspaces are as they were", layouts() == before)
    walk.check("and the scenes", len(bpy.data.scenes) == scenes)
    yield from walk.picture("workspace")
    window = bpy.context.window_manager.windows[0]
    window.workspace = bpy.data.workspaces[first]
    yield 1.0
    invoke("VIEW_3D", bpy.ops.mimetic.open_workspace)
    yield 1.0
    made = [one for one in bpy.data.workspaces if "mimetic_made" in one]
    walk.check("its button goes to the one that there is", shown() == made[0] and len(made) == 1)
    window.workspace = bpy.data.workspaces[first]
    yield 1.0
    invoke("VIEW_3D", bpy.ops.mimetic.find_face, frame=walk.settings["frame"])
    yield 1.0
    walk.check("Find Face shows what it looks in", shown().name == "Mimetic")
    jobs = importlib.import_module(f"{PACKAGE}.jobs")
    yield from walk.until(lambda: jobs.running is None, 200, "finding the face ends")


def bake(walk: Walk) -> Steps:
    bpy.ops.mimetic.load_performance(filepath=str(walk.folder / "take" / "performance.npz"))
    invoke("VIEW_3D", bpy.ops.mimetic.bake)
    jobs = importlib.import_module(f"{PACKAGE}.jobs")
    yield from walk.until(lambda: jobs.running is None, 200, "the bake ends")
    bpy.context.scene.frame_set(walk.settings["frame"])
    yield 1.0
    yield from walk.picture("workspace-baked")


def look(walk: Walk) -> Steps:
    """Cross-fade and lines, in solid mode and in material preview."""
    settings, face = bpy.context.scene.mimetic, bpy.context.scene.mimetic.face
    shading = area_of("VIEW_3D")[1].spaces.active.shading
    for mode in ("SOLID", "MATERIAL"):
        shading.type = mode
        yield 1.0 if mode == "SOLID" else 40.0  # EEVEE builds its shaders
        yield from walk.picture(f"face-{mode.lower()}")
        settings.face_cover = 0.4
        yield from walk.picture(f"face-{mode.lower()}-faded")
        settings.face_cover = 1.0
        press("VIEW_3D", "Y")
        yield from walk.until(lambda: face.display_type == "WIRE", 5, "Y shows the face as lines")
        yield from walk.picture(f"face-{mode.lower()}-lines")
        press("VIEW_3D", "Y")
        yield from walk.until(lambda: face.display_type == "TEXTURED", 5, "and Y again the face")
    press("VIEW_3D", "Y")
    yield 0.5
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.ed.undo()
    yield 0.5
    walk.check("an undo does, too", bpy.context.scene.mimetic.face.display_type == "TEXTURED")
    walk.check("and leaves the face", bpy.context.scene.mimetic.face is not None)


def render(walk: Walk) -> Steps:
    """By F12, in the engine that a new file has; the picture takes the place of an editor."""
    scene = bpy.context.scene
    bpy.context.preferences.view.render_display_type = "AREA"
    walk.check("nobody chose another engine", "EEVEE" in scene.render.engine, scene.render.engine)
    scene.eevee.taa_render_samples = SAMPLES
    scene.render.resolution_x, scene.render.resolution_y = scene.mimetic.clip.size
    area_of("VIEW_3D")[1].spaces.active.shading.type = "SOLID"
    done = []
    bpy.app.handlers.render_complete.append(lambda *_: done.append(True))
    press("VIEW_3D", "F12")
    yield from walk.until(lambda: bool(done), 400, "F12 renders")
    yield 2.0
    yield from walk.picture("rendered")
    bpy.data.images["Render Result"].save_render(str(walk.folder / "rendered.png"), scene=scene)


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from drop_a_clip(walk)
    yield from bake(walk)
    yield from look(walk)
    yield from render(walk)


start(steps)
