# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes on while editors and windows come and go, and a drag that is cancelled."""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from over_footage import (
    PACKAGE,
    click,
    clip,
    drag,
    go_to,
    in_window,
    is_idle,
    kept_frames,
    key,
    module,
    mouse,
    region_of,
)
from walk import Steps, Walk, area_of, install, invoke, override, start

NAME = "mouth_corner.L"
REST, LAST = 3, 12  # frames of the footage


def begin(walk: Walk) -> Steps:
    area_of("VIEW_3D")[1].type = "CLIP_EDITOR"
    yield 0.5
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    invoke("CLIP_EDITOR", bpy.ops.mimetic.find_face, frame=REST)
    yield from walk.until(is_idle, 120, "finding the face ends")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(walk.folder / "shot.blend"))
    yield from go_to(REST)


def landmark() -> tuple[int, int]:
    """Where the window shows the landmark."""
    track = clip().tracking.objects["Face"].tracks[NAME]
    frame = REST - clip().frame_offset
    place = track.markers.find_frame(frame, exact=True).co
    region = region_of()
    x, y = region.view2d.view_to_region(*place, clip=False)
    return region.x + x, region.y + y


def stored() -> tuple[str, bytes]:
    """The fit and its landmarks."""
    state = module("scene_out.landmarks").state(clip())
    return module("scene_out.face_fit").content(clip()), state


def move_a_landmark(walk: Walk, way: str) -> Steps:
    """G, the mouse, and a click: RIGHTMOUSE cancels, LEFTMOUSE keeps it."""
    place = np.array(landmark())
    yield from click(place)
    content, markers = stored()
    window, _ = area_of("CLIP_EDITOR")
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type="G", value=value, x=int(place[0]), y=int(place[1]))
    yield 0.3
    for step in (4, 8, 12):
        mouse("MOUSEMOVE", "NOTHING", np.add(place, (step, step // 2)))
        yield 0.4
    walk.check("the fit follows while it is moved", stored()[0] != content)
    for value in ("PRESS", "RELEASE"):
        mouse(way, value, np.add(place, (12, 6)))
    yield 1.0
    now = stored()
    if way == "LEFTMOUSE":
        walk.check("a landmark that was moved is pinned", now[0] != content)
        return
    off = np.abs(np.subtract(*(np.frombuffer(s, np.float32) for s in (now[1], markers)))).max()
    walk.check("cancelled, the fit is as before", now[0] == content)
    walk.check("and so are the landmarks", off < 1e-6, off)


def modal() -> list[str]:
    windows = bpy.context.window_manager.windows
    return [operator.bl_idname for window in windows for operator in window.modal_operators]


def pick_in_full_screen(walk: Walk) -> Steps:
    invoke("CLIP_EDITOR", bpy.ops.mimetic.pick_face)
    yield from full_screen(walk)
    x, y = in_window((-40, -40))
    yield from click((x, y))
    walk.check("a click beside the footage ends the picking", modal() == [], modal())
    yield from full_screen(walk)


def full_screen(walk: Walk) -> Steps:
    """To it, and back."""
    before = len(area_of("CLIP_EDITOR")[0].screen.areas)
    yield from key("SPACE", ctrl=True)
    now = len(area_of("CLIP_EDITOR")[0].screen.areas)
    walk.check("the editors changed", now != before, now)


def pin_in_full_screen(walk: Walk) -> Steps:
    for name in ("drag_pose", "pin_skin"):
        before = module("corrections").of_clip(clip())
        invoke("CLIP_EDITOR", getattr(bpy.ops.mimetic, name))
        yield from full_screen(walk)
        place = np.array(landmark())
        yield from drag(place, np.add(place, (10, 4)))
        now = module("corrections").of_clip(clip())
        walk.check(f"{name} is put where it was dragged", now != before and not modal(), now)
        yield from full_screen(walk)
    walk.check("of the frame on show", kept_frames() == [REST], kept_frames())


def new_window() -> Steps:
    window, _ = area_of("CLIP_EDITOR")
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.window_new_main()
    yield 2.0


def capture() -> Steps:
    settings = bpy.context.scene.mimetic
    settings.use_frame_range, settings.frame_first, settings.frame_last = True, 1, LAST
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture)
    yield 1.0


def close_its_window(walk: Walk) -> Steps:
    yield from new_window()
    yield from capture()
    run, windows = module("jobs").running, bpy.context.window_manager.windows
    with bpy.context.temp_override(window=windows[0]):
        bpy.ops.wm.window_close()
    yield 1.0
    walk.check("Blender goes on in the other window", len(windows) == 1, len(windows))
    walk.check("and the capture does", module("jobs").running is run and not run.stop.is_set())
    walk.check("in an operator there", modal() == ["MIMETIC_OT_capture"], modal())
    yield from walk.until(is_idle, 200, "it ends")
    rows = module("captured_takes").of_clip(clip())
    walk.check("its take is listed, whole", [row.last for row in rows] == [LAST], len(rows))
    yield from walk.picture("changing-editors-one-window")


def stop_in_another_window(walk: Walk) -> Steps:
    yield from new_window()
    yield from capture()
    run, windows = module("jobs").running, bpy.context.window_manager.windows
    walk.check(
        "it is at work in the first of two", [len(w.modal_operators) for w in windows][1] == 0
    )
    other = windows[1]
    for value in ("PRESS", "RELEASE"):
        other.event_simulate(type="ESC", value=value, x=other.width // 2, y=other.height // 2)
    yield from walk.until(lambda: run.stop.is_set(), 5, "Esc in the second window stops it")
    yield from walk.until(is_idle, 60, "and it ends")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from begin(walk)
    yield from move_a_landmark(walk, "RIGHTMOUSE")
    yield from move_a_landmark(walk, "LEFTMOUSE")
    yield from pick_in_full_screen(walk)
    yield from close_its_window(walk)
    yield from go_to(REST)
    yield from pin_in_full_screen(walk)
    yield from stop_in_another_window(walk)


start(steps)
