# SPDX-License-Identifier: GPL-3.0-or-later
"""A spoilt capture corrected by mouse: pins, a slider, Refine, undo, redo, saved and reopened."""

import importlib
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from over_footage import (
    PACKAGE,
    click,
    clip,
    drag,
    entry_at,
    go_to,
    in_window,
    is_idle,
    kept,
    kept_frames,
    key,
    module,
    mouse,
    region_of,
    take,
    take_path,
)
from walk import (
    Steps,
    Walk,
    area_of,
    install,
    invoke,
    open_sidebar,
    override,
    start,
    strip_columns,
)

LID, LID_FRAME = "lid_upper.L", 12
ROW = 22  # pixels between the redo panel's rows
NEAR = 10  # pixels of the footage, within which a click grabs the pin that is there


def captured_pixels(frame: int, points) -> np.ndarray:
    """Where the take has in a frame what is seen at these points in the first one."""
    corrections = importlib.import_module("mimetic.performance.corrections")
    pinned = importlib.import_module("mimetic.performance.pinned_places")
    places = importlib.import_module("mimetic.performance.places")
    template = importlib.import_module("mimetic.template.face_template").load_template()
    performance = take()
    surface = places.RefinedSurface(performance)
    pins = [
        corrections.SkinPin(*pinned.place_under(surface, tuple(point), 0), tuple(point))
        for point in points
    ]
    i = performance.index_of(frame)
    at = pinned.PinnedPlaces(template, pins).positions(performance.surface_in_camera(i))
    return performance.project(at)


def capture(walk: Walk) -> Steps:
    path = str(walk.folder / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    area_of("VIEW_3D")[1].type = "CLIP_EDITOR"
    yield 0.5
    area_of("CLIP_EDITOR")[1].spaces.active.show_region_toolbar = False
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / "spoilt.mp4"))
    yield from open_sidebar(walk, "CLIP_EDITOR", "Mimetic")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.find_face, frame=1)
    yield from walk.until(is_idle, 120, "finding the face ends")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    slow_down()
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture)
    yield from watch(walk)
    yield from walk.until(is_idle, 200, "the capture ends")
    walk.check("the take is beside the .blend", Path(take_path()).parent == walk.folder)


def watch(walk: Walk) -> Steps:
    """The face is drawn frame by frame while the capture works, and the playhead goes along."""
    scene, jobs = bpy.context.scene, module("jobs")
    seen = module("overlay.seen")

    def num_followed() -> int:
        return len(jobs.running.so_far) if jobs.running else 0

    yield from walk.until(lambda: num_followed() > 8, 200, "frames are followed")
    # It is moved by a timer, which a busy machine calls late
    yield from walk.until(lambda: scene.frame_current > 4, 20, "the playhead goes along")
    begin = scene.frame_current
    row = seen.at_work.drawn[0] if seen.at_work and seen.at_work.drawn else 0
    walk.check("the frame at hand is drawn", abs(row - begin) < 4, f"{row} at {begin}")
    yield from walk.picture("corrections-capture-at-work")
    yield from go_to(3)
    yield 0.5
    walk.check("the capture is still at work", not is_idle())
    walk.check("who scrubs is left where they are", scene.frame_current == 3, scene.frame_current)
    walk.check("and sees what was followed there", seen.at_work.drawn[0] == 3)


def slow_down() -> None:
    """The following of frames, so that there is time to look."""
    run = module("jobs").Run
    progress = run.progress

    def slowly(self, fraction: float, what: str = "") -> bool:
        if "following" in what:
            time.sleep(0.15)
        return progress(self, fraction, what)

    run.progress = slowly


def without_grabbing(begins, ends) -> list[tuple]:
    """Drags in an order in which none begins where a pin was put before."""
    ordered, drags = [], list(zip(begins, ends, strict=True))
    while drags:
        free = [
            drag
            for drag in drags
            if all(other is drag or apart(other[0], drag[1]) > NEAR for other in drags)
        ]
        ordered.append((free or drags)[0])
        drags = [drag for drag in drags if drag is not ordered[-1]]
    return ordered


def apart(one, other) -> float:
    return np.abs(np.subtract(one, other)).max()


def pin_the_mouth(walk: Walk) -> Steps:
    """In two of the frames in which it is covered, each pin to where the skin truly is."""
    points = walk.settings["points"]
    for frame in walk.settings["corrected"]:
        yield from go_to(frame)
        if frame == walk.settings["corrected"][0]:
            yield from walk.picture("corrections-spoilt")
        seen = captured_pixels(frame, points)
        for begin, end in without_grabbing(seen, walk.settings["true"][str(frame)]):
            invoke("CLIP_EDITOR", bpy.ops.mimetic.pin_skin)
            yield 0.3
            yield from drag(in_window(begin), in_window(end))
            pixels = [pin.pixel for entry in kept() if entry.frame == frame for pin in entry.pins]
            off = min((np.abs(np.subtract(p, end)).max() for p in pixels), default=np.inf)
            walk.check("a pin is where the mouse left it", off < 1, f"{off:.2f} px")
    walk.check("both frames are corrected", kept_frames() == walk.settings["corrected"])
    counts = [len(entry.pins) for entry in kept()]
    walk.check("each with all pins", counts == [len(points)] * 2, counts)
    walk.arrays["pins"] = [list(in_window(pin.pixel)) for pin in kept()[-1].pins]
    frames = [walk.settings["corrected"][0], walk.settings["corrected"][0] - 2]
    clock = module("scene_in").timing(bpy.context.scene, clip())
    at = module("scene_in").scene_frames_of(frames, clip().fps, clock)  # where keys would be
    walk.arrays["strip"] = strip_columns("DOPESHEET_EDITOR", at.tolist())
    yield from walk.picture("corrections-pinned")


def click_beside(walk: Walk) -> Steps:
    """While a place is looked for: on a sidebar that lies over the footage."""
    before = kept()
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_zoom_ratio(ratio=4.0)
    yield 0.5
    sidebar = region_of("UI")
    # On one of the lines of text about frame rates: a button would take the click
    place = sidebar.x + sidebar.width // 2, sidebar.y + sidebar.height - 150
    invoke("CLIP_EDITOR", bpy.ops.mimetic.pin_skin)
    yield 0.3
    mouse("MOUSEMOVE", "NOTHING", place)
    for value in ("PRESS", "RELEASE"):
        mouse("LEFTMOUSE", value, place)
    yield 0.5
    running = [operator.bl_idname for operator in area_of("CLIP_EDITOR")[0].modal_operators]
    walk.check(
        "a click on the sidebar is none on the footage", "MIMETIC_OT_pin_skin" in running, running
    )
    walk.check("and corrects nothing", kept() == before)
    yield from key("ESC")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    yield 0.3


def change_ones_mind(walk: Walk) -> Steps:
    """Escape in the middle of a drag, undo and redo."""
    before = kept()
    frame = walk.settings["corrected"][-1]
    (begin, *_), (end, *_) = ([walk.settings["true"][str(frame)][i]] for i in (0, 1))
    invoke("CLIP_EDITOR", bpy.ops.mimetic.pin_skin)
    yield 0.3
    yield from drag(in_window(begin), in_window(end), is_released=False)
    walk.check("a pin moves with the mouse", kept() != before)
    yield from key("ESC")
    walk.check("Esc in a drag leaves it where it was", kept() == before)
    mouse("LEFTMOUSE", "RELEASE", in_window(end))
    yield 0.2
    yield from key("Z", ctrl=True)
    num_points = len(walk.settings["points"])
    pinned = [num_points, num_points - 1]
    walk.check("one undo takes the last pin alone", [len(e.pins) for e in kept()] == pinned, kept())
    yield from key("Z", ctrl=True, shift=True)
    walk.check("redo puts it back", kept() == before)


def state_a_lid(walk: Walk) -> Steps:
    """By the slider of the redo panel, from the value that was captured."""
    yield from go_to(LID_FRAME)
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.mimetic.correct_value("INVOKE_DEFAULT", True, value_name=LID, reach=6.0)
    yield 0.7
    stated = {entry.frame: entry.values for entry in kept()}
    walk.check("a lid is stated as captured", LID in stated.get(LID_FRAME, {}), stated)
    before = stated[LID_FRAME][LID].value
    hud = region_of("HUD")
    yield from click((hud.x + 60, hud.y + hud.height - 12))  # its header, which opens it
    hud = region_of("HUD")
    field = np.array([hud.x + 0.75 * hud.width, hud.y + 8 + 2.5 * ROW])  # above Deviation and Reach
    yield from walk.picture("corrections-slider")
    yield from drag(field, (field[0] + 60, field[1]))
    yield from walk.picture("corrections-slid")
    seen = module("overlay.seen").last_take()
    walk.check(
        "the face is drawn as stated", seen.stated is not None and seen.stated[2] is not None
    )
    after = {entry.frame: entry.values for entry in kept()}.get(LID_FRAME, {}).get(LID)
    is_moved = after is not None and after.value > before + 0.02
    walk.check("the slider of the redo panel moves it", is_moved, (before, after))
    shown = bpy.context.scene.frame_current
    walk.check("in the frame on show, which stays", shown == LID_FRAME, shown)
    walk.check("without another correction", len(kept()) == 3, kept_frames())
    yield from state_again(walk, after)
    yield from count_drawing(walk)


def state_again(walk: Walk, stated) -> Steps:
    """A button pressed once more begins at what is stated, and changes nothing by itself."""
    before = kept()
    invoke("CLIP_EDITOR", bpy.ops.mimetic.correct_value, value_name=LID, reach=6.0)
    yield 0.5
    pinned = entry_at(LID_FRAME).values[LID]
    is_kept = abs(pinned.value - stated.value) + abs(pinned.std - stated.std) < 1e-6
    walk.check("Correct begins at the value that is stated", is_kept, (stated, pinned))
    walk.check("and leaves all others", [e.frame for e in kept()] == [e.frame for e in before])


def drag_the_head(walk: Walk) -> Steps:
    """Moved by the mouse, turned after R; Escape leaves it, each drag is one step of undo."""
    before, size = kept(), clip().size
    captured = take().head_pose[LID_FRAME - 1]
    begin = in_window((size[0] / 2, size[1] / 2))
    end = (begin[0] + 24, begin[1])
    invoke("CLIP_EDITOR", bpy.ops.mimetic.drag_pose)
    yield 0.3
    yield from drag(begin, end, is_released=False)
    walk.check("the head moves with the mouse", entry_at(LID_FRAME).pose is not None)
    yield from walk.picture("corrections-head-dragged")
    yield from key("ESC")
    walk.check("Esc leaves the head where it was", kept() == before)
    mouse("LEFTMOUSE", "RELEASE", end)
    yield 0.2
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.mimetic.drag_pose("INVOKE_DEFAULT", True)
    yield 0.3
    yield from drag(begin, end)
    moved = entry_at(LID_FRAME).pose
    beside = 0.0 if moved is None else moved.head_pose[0, 3] - captured[0, 3]
    walk.check("a drag states the pose", beside > 0.005, f"{1000 * beside:.1f} mm to the right")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.mimetic.drag_pose("INVOKE_DEFAULT", True)
    yield 0.3
    yield from key("R")
    yield from drag(begin, end)
    turned = entry_at(LID_FRAME).pose
    is_turned = np.abs(turned.head_pose[:3, :3] - captured[:3, :3]).max() > 0.05
    stays = np.allclose(turned.head_pose[:3, 3], moved.head_pose[:3, 3], atol=1e-5)
    walk.check("after R it turns, from where it was moved to", is_turned and stays, turned)
    yield from walk.picture("corrections-head-turned")
    yield from key("Z", ctrl=True)
    pose = entry_at(LID_FRAME).pose
    walk.check("one undo takes the turn alone", np.allclose(pose.head_pose, moved.head_pose))
    yield from key("Z", ctrl=True)
    walk.check("one more the move", entry_at(LID_FRAME).pose is None)
    walk.check("and no more", [e.frame for e in kept()] == [e.frame for e in before])


def count_drawing(walk: Walk) -> Steps:
    """The stated face's lines are found once, and once more as what is stated changes: finding them
    is what drawing costs (scripts/bench_face_lines)."""
    overlay, seen = module("overlay.captured"), module("overlay.seen").last_take()
    draw_capture, find_lines, drawn, found = overlay.draw_capture, seen.lines.draw, [], []

    def draw(context) -> bool:
        drawn.append(context.area.type)
        return draw_capture(context)

    def find(row, entry=None):
        found.append(entry)
        return find_lines(row, entry)

    overlay.draw_capture, seen.lines.draw = draw, find
    for _ in range(5):
        region_of().tag_redraw()
        yield 0.1
    walk.check(
        "what is stated is drawn again, and not found again", drawn and not found, len(drawn)
    )
    pinned = entry_at(LID_FRAME).values[LID]
    told = {"value_name": LID, "std": pinned.std, "reach": 6.0}
    invoke("CLIP_EDITOR", bpy.ops.mimetic.correct_value, value=pinned.value / 2, **told)
    for _ in range(5):
        region_of().tag_redraw()
        yield 0.1
    stated = [entry.values[LID].value for entry in found]
    is_once = len(stated) == 1 and abs(stated[0] - pinned.value / 2) < 1e-6
    walk.check("changed once, it is found once", is_once, stated)
    overlay.draw_capture, seen.lines.draw = draw_capture, find_lines
    invoke("CLIP_EDITOR", bpy.ops.mimetic.correct_value, value=pinned.value, **told)
    yield 0.3


def refine(walk: Walk) -> Steps:
    before = take_path()
    invoke("CLIP_EDITOR", bpy.ops.mimetic.refine)
    yield from walk.until(is_idle, 120, "refining ends")
    yield 0.5
    walk.check("it makes a take of its own", take_path() != before, take_path())
    frame = walk.settings["corrected"][0]
    yield from go_to(frame)
    yield from walk.picture("corrections-refined")
    seen = captured_pixels(frame, walk.settings["points"])
    off = np.linalg.norm(seen - walk.settings["true"][str(frame)], axis=1)
    walk.check("the skin is at its pins", off.max() < 2, off.round(2))
    after = take_path()
    yield from key("Z", ctrl=True)
    walk.check("one undo goes back to the take before", take_path() == before, take_path())
    walk.check("and keeps the corrections", len(kept()) == 3, kept_frames())
    yield from key("Z", ctrl=True, shift=True)
    walk.check("redo to the refined one", take_path() == after, take_path())


def open_again(walk: Walk) -> Steps:
    before, path = kept(), take_path()
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    yield 1.5
    walk.check("the corrections are in the file", kept() == before)
    walk.check("so is the take", take_path() == path, take_path())
    yield from go_to(walk.settings["corrected"][-1])
    yield from walk.picture("corrections-reopened")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from capture(walk)
    yield from pin_the_mouth(walk)
    yield from click_beside(walk)
    yield from change_ones_mind(walk)
    yield from state_a_lid(walk)
    yield from drag_the_head(walk)
    yield from refine(walk)
    yield from open_again(walk)


start(steps)
