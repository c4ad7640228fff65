# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked file is opened in a window: it shows the face over its footage, curves, sliders."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, override, start


def look(walk: Walk) -> Steps:
    yield 2.0  # the first frame of the footage is read
    _, view = area_of("VIEW_3D")
    perspective = view.spaces.active.region_3d.view_perspective
    walk.check("the view looks through the camera", perspective == "CAMERA", perspective)
    kinds = [area.type for area in bpy.context.window.screen.areas]
    walk.check("curves are beside", "GRAPH_EDITOR" in kinds, kinds)
    shown = [
        a.spaces.active.context for a in bpy.context.window.screen.areas if a.type == "PROPERTIES"
    ]
    walk.check("sliders are beside", shown == ["DATA"], shown)
    yield from walk.picture("opened")
    bpy.context.scene.frame_set(walk.settings["frame"])
    yield 1.0
    yield from walk.picture("opened-later")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.screen.animation_play()
    first = bpy.context.scene.frame_current
    yield 3.0
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.screen.animation_cancel(restore_frame=False)
    walk.check("it plays", bpy.context.scene.frame_current != first)


bpy.ops.wm.open_mainfile(filepath=str(Path(__file__).parent / "face.blend"), load_ui=True)
start(look)
