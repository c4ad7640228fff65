# SPDX-License-Identifier: GPL-3.0-or-later
"""A spoilt capture corrected by mouse: pins, a slider, Refine, undo, redo, saved and reopened."""

import importlib
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
LID, LID_FRAME = "lid_upper.L", 12
ROW = 22  # pixels between the redo panel's rows
MOVES = 8  # of the mouse in a drag
NEAR = 10  # pixels of the footage, within which a click grabs the pin that is there


def module(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def is_idle() -> bool:
    return module("jobs").running is None


def clip() -> bpy.types.MovieClip:
    return bpy.context.scene.mimetic.clip


def take_path() -> str:
    takes = module("takes")
    return takes.find(takes.of_clip(bpy.context.scene, clip()))


def take():
    return importlib.import_module("mimetic.performance.document").Performance.load(take_path())


def kept() -> tuple:
    return module("corrections").of_clip(clip())


def kept_frames() -> list[int]:
    return [entry.frame for entry in kept()]


def go_to(frame: int) -> Steps:
    """As keys and the timeline do it."""
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.screen.frame_offset(delta=frame - bpy.context.scene.frame_current)
    yield 0.5


def region_of(kind: str = "WINDOW") -> bpy.types.Region:
    _, area = area_of("CLIP_EDITOR")
    return next(region for region in area.regions if region.type == kind)


def in_window(pixel) -> tuple[int, int]:
    """Where the window shows a pixel of the footage."""
    width, height = clip().size
    place = (pixel[0] + 0.5) / width, 1 - (pixel[1] + 0.5) / height
    region = region_of()
    x, y = region.view2d.view_to_region(*place, clip=False)
    return region.x + x, region.y + y


def mouse(kind: str, value: str, place) -> None:
    window, _ = area_of("CLIP_EDITOR")
    window.event_simulate(type=kind, value=value, x=round(place[0]), y=round(place[1]))


def key(kind: str, **held: bool) -> Steps:
    """With the mouse over the footage."""
    window, area = area_of("CLIP_EDITOR")
    x, y = area.x + area.width // 2, area.y + area.height // 2
    mouse("MOUSEMOVE", "NOTHING", (x, y))
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type=kind, value=value, x=x, y=y, **held)
    yield 0.7


def drag(begin, end, is_released: bool = True) -> Steps:
    """From one place of the window to another."""
    begin, end = np.array(begin, dtype=float), np.array(end, dtype=float)
    mouse("MOUSEMOVE", "NOTHING", begin)
    yield 0.2
    mouse("LEFTMOUSE", "PRESS", begin)
    yield 0.1
    for step in range(1, MOVES + 1):
        mouse("MOUSEMOVE", "NOTHING", begin + (end - begin) * step / MOVES)
        yield 0.05
    if is_released:
        mouse("LEFTMOUSE", "RELEASE", end)
        yield 0.4


def click(place) -> Steps:
    mouse("MOUSEMOVE", "NOTHING", place)
    yield 0.2
    for value in ("PRESS", "RELEASE"):
        mouse("LEFTMOUSE", value, place)
    yield 0.7


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
    captured = module("overlay.captured")

    def num_followed() -> int:
        return len(jobs.running.so_far) if jobs.running else 0

    yield from walk.until(lambda: num_followed() > 8, 200, "frames are followed")
    yield 0.2
    begin = scene.frame_current
    walk.check("the playhead goes along", begin > 4, begin)
    row = captured._at_work.drawn[0] if captured._at_work and captured._at_work.drawn else 0
    walk.check("the frame at hand is drawn", abs(row - begin) < 4, f"{row} at {begin}")
    yield from walk.picture("corrections-capture-at-work")
    yield from go_to(3)
    yield 0.5
    walk.check("the capture is still at work", not is_idle())
    walk.check("who scrubs is left where they are", scene.frame_current == 3, scene.frame_current)
    walk.check("and sees what was followed there", captured._at_work.drawn[0] == 3)


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
    yield from walk.picture("corrections-pinned")


def click_beside(walk: Walk) -> Steps:
    """While a place is looked for: on a sidebar that lies over the footage."""
    before = kept()
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_zoom_ratio(ratio=4.0)
    yield 0.5
    sidebar = region_of("UI")
    place = sidebar.x + sidebar.width // 2, sidebar.y + sidebar.height - 98  # on a line of text
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
    after = {entry.frame: entry.values for entry in kept()}.get(LID_FRAME, {}).get(LID)
    is_moved = after is not None and after.value > before + 0.02
    walk.check("the slider of the redo panel moves it", is_moved, (before, after))
    shown = bpy.context.scene.frame_current
    walk.check("in the frame on show, which stays", shown == LID_FRAME, shown)
    walk.check("without another correction", len(kept()) == 3, kept_frames())


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
    yield from refine(walk)
    yield from open_again(walk)


start(steps)
