# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender is closed while a capture is at work."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, start

PACKAGE = "bl_ext.user_default.mimetic"


def running():
    return sys.modules[f"{PACKAGE}.jobs"].running


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    area_of("VIEW_3D")[1].type = "CLIP_EDITOR"
    yield 0.5
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    bpy.ops.mimetic.find_face(frame=3)
    bpy.ops.wm.save_as_mainfile(filepath=str(walk.folder / "shot.blend"))
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture)
    yield from walk.until(lambda: running() and len(running().so_far) > 12, 200, "it is at work")
    # The walk ends, and Blender with it


start(steps)
