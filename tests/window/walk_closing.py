# SPDX-License-Identifier: GPL-3.0-or-later
"""The close button is pressed while a capture is at work: Blender asks, and does as it is told."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, start

PACKAGE = "bl_ext.user_default.mimetic"


def running():
    return sys.modules[f"{PACKAGE}.jobs"].running


def followed() -> int:
    return len(running().so_far) if running() else 0


def save_and_capture(walk: Walk) -> Steps:
    bpy.ops.wm.save_as_mainfile(filepath=str(walk.folder / "shot.blend"))
    yield 0.5
    walk.check("a saved file is no reason to ask", not bpy.data.is_dirty)
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture)
    yield from walk.until(lambda: followed() > 12, 200, "it is at work")


def stay(walk: Walk) -> Steps:
    """Blender asks, and Esc, which means the question, leaves the capture at work."""
    walk.check("a capture at work is a reason to ask", bpy.data.is_dirty)
    yield from walk.ask("stay.close")
    yield 2.0
    yield from walk.picture("closing-asks")
    yield from walk.ask("stay.act", "key Escape")
    yield 1.0
    walk.check("after Esc it is still at work", running() and not running().stop.is_set())
    before = followed()
    yield from walk.until(lambda: followed() > before + 3, 100, "and goes on")


def leave(walk: Walk) -> Steps:
    """Saved in the middle, it asks all the same; then it closes, and the walk with it."""
    bpy.ops.wm.save_mainfile()
    yield 1.0  # until Blender has come to take the file for saved, and the job has ticked
    walk.check("saving in the middle changes nothing", bpy.data.is_dirty)
    yield from walk.ask("leave.close")
    yield 2.0
    walk.check("it is at work when Blender closes", running() is not None)
    place = walk.settings["answer"]
    walk.close()  # no step is taken after the answer
    yield from walk.ask("leave.act", "mousemove {} {} sleep 0.5 click 1".format(*place))
    yield 60.0
    raise AssertionError("Blender did not close")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    area_of("VIEW_3D")[1].type = "CLIP_EDITOR"
    yield 0.5
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    bpy.ops.mimetic.find_face(frame=3)
    yield from save_and_capture(walk)
    yield from stay(walk)
    yield from leave(walk)


start(steps)
