# SPDX-License-Identifier: GPL-3.0-or-later
"""A face driven live in a window: it follows a clip, a take is punched in, Esc ends, one undo."""

import importlib
import sys
import time
from pathlib import Path

import bpy
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, press, start

PACKAGE = "bl_ext.user_default.mimetic"
LOOKED = 4.0  # seconds in which pictures are counted


def live():
    return importlib.import_module(f"{PACKAGE}.live")


def is_idle() -> bool:
    return importlib.import_module(f"{PACKAGE}.jobs").running is None


def values() -> tuple[float, ...]:
    face = bpy.context.view_layer.objects.active
    return tuple(key.value for key in face.data.shape_keys.key_blocks)


def num_worked_on() -> int:
    session = live().active.thread.session
    return session.figures.num_pictures if session else 0


def add_the_face(walk: Walk) -> Steps:
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    invoke("VIEW_3D", bpy.ops.mimetic.add_face)
    yield from walk.until(is_idle, 120, "adding the face ends")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_selected()
    region = area_of("VIEW_3D")[1].spaces.active.region_3d
    region.view_rotation = Euler((1.5, 0, 0.2)).to_quaternion()
    region.view_distance *= 0.8
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    settings = bpy.context.scene.mimetic.live
    settings.source = "CLIP"
    settings.clip_path = str(walk.folder / walk.settings["clip"])


def follow(walk: Walk) -> Steps:
    before = values()
    bpy.ops.ed.undo_push(message="before")
    invoke("VIEW_3D", bpy.ops.mimetic.live)
    walk.check("the session runs beside the window", live().active is not None)
    yield from walk.until(lambda: values() != before, 60, "the face follows")
    first, start = num_worked_on(), time.monotonic()
    seen = set()
    while time.monotonic() - start < LOOKED:
        seen.add(values())
        yield 0.01
    rate = (num_worked_on() - first) / LOOKED
    walk.check("pictures are worked on all the time", rate > 2, f"{rate:.1f} a second")
    walk.check("and shown", len(seen) > LOOKED, f"{len(seen) / LOOKED:.1f} a second")
    yield from walk.picture("live")


def record(walk: Walk) -> Steps:
    bpy.context.scene.frame_set(20)
    press("VIEW_3D", "R")
    yield from walk.until(lambda: live().active.is_recording, 5, "R begins a take")
    yield 2.0
    bpy.context.scene.mimetic.live.stillness = 0.9
    yield from walk.picture("live-recording")
    press("VIEW_3D", "R")
    yield from walk.until(lambda: live().active.takes, 20, "R ends it")
    press("VIEW_3D", "N")
    yield 1.0
    press("VIEW_3D", "ESC")
    yield from walk.until(is_idle, 20, "Esc ends the session")
    face = bpy.context.view_layer.objects.active
    animation = face.data.shape_keys.animation_data
    walk.check("the take is an action", animation is not None and animation.action is not None)
    sounds = len(bpy.data.sounds)
    walk.check("a clip without sound lays none", sounds == 0, sounds)
    yield from walk.picture("live-done")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.ed.undo()
    yield 0.5
    face = bpy.context.view_layer.objects.active
    animation = face.data.shape_keys.animation_data
    walk.check("one undo takes it back", animation is None or animation.action is None)


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from add_the_face(walk)
    yield from follow(walk)
    yield from record(walk)


start(steps)
