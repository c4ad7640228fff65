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


def drawn_fast() -> tuple[bool, ...]:
    """What Fast View lowers: each must be off while a session runs, and on before and after."""
    face = bpy.context.view_layer.objects.active
    return (
        face.modifiers["Subdivision"].show_viewport,
        bpy.context.preferences.system.viewport_aa != "OFF",
        area_of("VIEW_3D")[1].spaces.active.overlay.show_overlays,
        area_of("VIEW_3D")[1].spaces.active.shading.show_object_outline,
    )


def follow(walk: Walk) -> Steps:
    before = values()
    walk.check("all is drawn before", all(drawn_fast()), drawn_fast())
    bpy.ops.ed.undo_push(message="before")
    invoke("VIEW_3D", bpy.ops.mimetic.live)
    walk.check("the session runs beside the window", live().active is not None)
    walk.check("it is drawn fast", not any(drawn_fast()), drawn_fast())
    yield from walk.until(lambda: values() != before, 60, "the face follows")
    first, start = num_worked_on(), time.monotonic()
    seen = set()
    while time.monotonic() - start < LOOKED:
        seen.add(values())
        yield 0.01
    rate = (num_worked_on() - first) / LOOKED
    walk.check("pictures are worked on all the time", rate > 2, f"{rate:.1f} a second")
    walk.check("and shown", len(seen) > LOOKED, f"{len(seen) / LOOKED:.1f} a second")
    view = live().active.view
    walk.check("the camera's picture is drawn", view._texture is not None, view._texture)
    lines = live().active.thread.trace.draw(0, 0, 9, 9)
    walk.check("the plots have lines", len(lines.points) > 99, len(lines.points))
    yield from walk.picture("live")
    settings = bpy.context.scene.mimetic.live
    settings.show_plots, settings.view_corner, settings.view_size = False, "TOP_RIGHT", 320
    yield from walk.picture("live-picture-alone")
    settings.show_picture = False
    yield 0.5
    drawn = view._shown
    yield 1.0
    walk.check("switched off nothing is drawn", view._shown is drawn)
    settings.show_picture = settings.show_plots = True


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
    view = live().active.view
    press("VIEW_3D", "ESC")
    yield from walk.until(is_idle, 20, "Esc ends the session")
    walk.check("nothing is left of picture and plots", view._handle is None and not view._texture)
    walk.check("all is drawn again", all(drawn_fast()), drawn_fast())
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


def load_a_file(walk: Walk) -> Steps:
    """While a session runs: it ends, and what it lowered is put back."""
    path = str(walk.folder / "session.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    view_of = live()
    invoke("VIEW_3D", bpy.ops.mimetic.live)
    view = view_of.active.view
    yield 1.0
    walk.check("it is drawn fast again", not any(drawn_fast()), drawn_fast())
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 1.0
    walk.check("a file that is opened ends the session", live().active is None and is_idle())
    walk.check("it leaves no drawing behind", view._handle is None)
    walk.check("and all is drawn as before", all(drawn_fast()), drawn_fast())


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from add_the_face(walk)
    yield from follow(walk)
    yield from record(walk)
    yield from load_a_file(walk)


start(steps)
