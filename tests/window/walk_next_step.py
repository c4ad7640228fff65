# SPDX-License-Identifier: GPL-3.0-or-later
"""Someone new: a video is dropped, then only what is lit is clicked, and a place that is off is
pinned. All of it by the screen's own mouse; how long each step takes is told. After each an undo
leaves nothing of it, and a redo brings it back, which takes no time of theirs."""

import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import redo_panels
from undoing import (
    PACKAGE,
    at_rest,
    difference,
    document,
    module,
    on_screen,
    press,
    undo_and_redo,
    views,
)
from walk import Steps, Walk, area_of, install, override, start

WAY = ("find_face", "capture", "bake", "pin_skin", "refine", "bake")  # what the panel leads to
OFF = 6  # pixels of the screen by which the place that is pinned is moved


def is_idle() -> bool:
    return module("jobs").running is None


def next_name() -> str:
    """What the panel says comes next, for the steps' names alone: the click goes by its colour."""
    window, area = area_of("CLIP_EDITOR")
    with bpy.context.temp_override(window=window, area=area):
        return module("next_step").of(bpy.context).operator.removeprefix("mimetic.")


def part(kind: str) -> bpy.types.Region:
    return next(region for region in area_of("CLIP_EDITOR")[1].regions if region.type == kind)


def sidebar_box() -> str:
    region = part("UI")
    left, top = on_screen(region.x, region.y + region.height - 1)
    return f"{left} {top} {region.width} {region.height}"


class Stopwatch:
    """Seconds of each step: until it is clicked, and what the machine computes for it."""

    def __init__(self, walk: Walk) -> None:
        self._rows = walk.arrays["steps"] = []
        self._begin = time.monotonic()

    def clicked(self, name: str) -> None:
        now = time.monotonic()
        self._rows.append([name, now - self._begin, 0.0])
        self._begin = now

    def done(self) -> None:
        now = time.monotonic()
        self._rows[-1][2] = now - self._begin
        self._begin = now

    def go_on(self) -> None:
        """After what is not of the way."""
        self._begin = time.monotonic()


def drop(walk: Walk, watch: Stopwatch) -> Steps:
    view = area_of("VIEW_3D")[1]
    x, y = on_screen(view.x + view.width // 2, view.y + view.height // 2)
    yield from walk.ask("next-drop.drop", f"{x} {y} {walk.folder / walk.settings['clip']}")
    yield from walk.picture("next-dropped")
    # Blender asks what to do with it, Load Clip beneath the mouse
    yield from walk.ask("next-dropped.act", "click 1")
    watch.clicked("drop the video")

    def is_complete() -> bool:
        kinds = {area.type for area in bpy.context.window_manager.windows[0].screen.areas}
        if bpy.context.scene.mimetic.clip is None or not {"GRAPH_EDITOR", "CLIP_EDITOR"} <= kinds:
            return False
        return getattr(part("UI"), "active_panel_category", "") == "Mimetic"

    yield from walk.until(is_complete, 20, "the dropped video opens the workspace")
    yield 0.5
    watch.done()


def click_lit(walk: Walk, watch: Stopwatch, i: int) -> Steps:
    name = next_name()
    walk.check("the next step is as expected", name == WAY[i], (name, WAY[i]))
    yield from walk.ask(f"next-{i}-{name}.click", f"lit {sidebar_box()}")
    watch.clicked(name.replace("_", " "))
    yield from walk.until(lambda: next_name() != name or not is_idle(), 20, f"{name} begins")
    yield from walk.until(lambda: next_name() != name and is_idle(), 300, f"{name} leads on")
    watch.done()
    yield 0.5


def pin_a_place(walk: Walk, watch: Stopwatch, i: int) -> Steps:
    """By the button below the words that the face is baked: from the face's middle down a bit."""
    walk.check("nothing is lit", next_name() == "", next_name())
    yield from walk.ask(f"next-{i}-pin_skin.click", f"plain {sidebar_box()}")
    running = area_of("CLIP_EDITOR")[0].modal_operators
    yield from walk.until(lambda: len(running) > 0, 10, "Pin Skin waits for a place")
    pixel = nose_tip()
    width, height = bpy.context.scene.mimetic.clip.size
    region = part("WINDOW")
    place = (pixel[0] + 0.5) / width, 1 - (pixel[1] + 0.5) / height
    x, y = region.view2d.view_to_region(*place, clip=False)
    x, y = on_screen(region.x + x, region.y + y)
    drag = f"mousemove {x} {y} sleep 0.3 mousedown 1 sleep 0.2 mousemove {x} {y + OFF // 2} "
    drag += f"sleep 0.2 mousemove {x} {y + OFF} sleep 0.2 mouseup 1"
    yield from walk.ask("next-drag.act", drag)
    watch.clicked("pin skin")
    yield from walk.until(lambda: next_name() == "refine", 10, "the pin is to be refined")
    watch.done()
    yield 0.5


def nose_tip():
    """In the frame on show, in pixels of the footage."""
    window, area = area_of("CLIP_EDITOR")
    with bpy.context.temp_override(window=window, area=area):
        performance = module("shown_take").performance(bpy.context)
        i = performance.index_of(module("scene_in").shown_frame(bpy.context))
    template = sys.modules["mimetic.template.face_template"].load_template()
    return performance.project(performance.surface_in_camera(i))[template.landmark("nose_tip")]


def drop_another(walk: Walk) -> Steps:
    """On the clip editor, where Blender opens it itself: the panel is of the clip on show."""
    first = bpy.context.scene.mimetic.clip
    region = part("WINDOW")
    x, y = on_screen(region.x + region.width // 4, region.y + region.height // 2)
    yield from walk.ask("next-another.drop", f"{x} {y} {walk.folder / walk.settings['another']}")
    yield from walk.picture("next-another")
    shown = area_of("CLIP_EDITOR")[1].spaces.active.clip
    walk.check("a video that is dropped on the clip editor is on show", shown != first, shown.name)
    walk.check("and its face is to be found", next_name() == "find_face", next_name())
    area_of("CLIP_EDITOR")[1].spaces.active.clip = first
    walk.check("the first one has its take", next_name() == "", next_name())


def search(walk: Walk, name: str, kind: str, words: str) -> Steps:
    """By F3, and what it finds first."""
    yield from press(walk, f"{name}-search", kind, "F3")
    keys = " ".join("space" if letter == " " else letter for letter in words.lower())
    yield from walk.ask(f"{name}-words.act", f"sleep 0.5 key {keys}")
    yield from walk.picture(f"{name}-found")
    yield from walk.ask(f"{name}-chosen.act", "key Return")


def correct_and_smooth(walk: Walk) -> Steps:
    """What has settings that one tries out: each from its menu, then in its redo panel."""
    for operator, kind, words, setting, typed in (
        ("correct_value", "CLIP_EDITOR", "Correct Value", "value", "0.4"),
        ("smooth_curves", "VIEW_3D", "Mimetic Smooth", "seconds", "0.3"),
    ):
        before, name = document(), f"next-{operator}"
        yield from search(walk, name, kind, words)
        ran = f"MIMETIC_OT_{operator}"
        yield from walk.until(lambda r=ran: redo_panels.last().bl_idname == r, 20, f"{name} ran")
        yield from redo_panels.try_out(walk, name, before, kind, setting, typed)


def without_lists(written: dict) -> dict:
    """Blender saves no data-blocks that nothing uses."""
    return {name: value for name, value in written.items() if not name.startswith("all ")}


def move_elsewhere(walk: Walk) -> Steps:
    """Saved by its key, the folder moved, and opened there: nothing is missing."""
    yield from press(walk, "next-save", "VIEW_3D", "ctrl+s")
    yield from walk.until(lambda: not bpy.data.is_dirty, 20, "Ctrl+S saves the file")
    before, takes = document(), module("takes")
    elsewhere = walk.folder / "elsewhere"
    elsewhere.mkdir()
    for path in [p for p in walk.folder.iterdir() if p.suffix in {".blend", ".mp4", ".npz"}]:
        path.rename(elsewhere / path.name)
    bpy.ops.wm.open_mainfile(filepath=str(elsewhere / "shot.blend"))
    yield 2.0
    scene = bpy.context.scene
    take = Path(takes.find(takes.of_clip(scene, scene.mimetic.clip)))
    walk.check("the take is found where the file is", take.parent == elsewhere, take)
    film = Path(bpy.path.abspath(scene.mimetic.clip.filepath)).resolve()
    walk.check("and the footage", film == (elsewhere / "shot.mp4").resolve(), film)
    behind = bpy.context.scene.camera.data.background_images[0]
    film = Path(bpy.path.abspath((behind.image or behind.clip).filepath)).resolve()
    walk.check("it is behind the face", film == (elsewhere / "shot.mp4").resolve(), film)
    found = difference(*map(without_lists, (before, document())))
    walk.check("all else is as it was", not found, found)
    yield from walk.picture("next-elsewhere")
    with bpy.context.temp_override(**override("VIEW_3D")):
        answer = bpy.ops.mimetic.bake("EXEC_DEFAULT", True)
    walk.check("and is baked again there", answer == {"FINISHED"}, answer)


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.ops.wm.save_as_mainfile(filepath=str(walk.folder / "shot.blend"))
    yield 0.5
    before = yield from at_rest(walk, "Blender")
    watch = Stopwatch(walk)
    yield from drop(walk, watch)
    walk.check("the video is the scene's", bpy.context.scene.mimetic.clip is not None)
    yield from undo_and_redo(walk, "next-drop", before)
    for i, name in enumerate(WAY):
        before, looks = document(), views()
        watch.go_on()
        yield from (pin_a_place if name == "pin_skin" else click_lit)(walk, watch, i)
        step = f"next-{i}-{name}"
        if i == len(WAY) - 1:
            setting = "exaggeration", "1.5", 3
            yield from redo_panels.try_out(walk, step, before, "CLIP_EDITOR", *setting)
        else:
            editor = "CLIP_EDITOR" if name == "pin_skin" else "VIEW_3D"
            yield from undo_and_redo(walk, step, before, editor, looks)
    yield from walk.picture("next-done")
    face = bpy.context.scene.mimetic.face
    takes = [row.performance for row in face.mimetic.takes]
    walk.check("the corrected take is baked too", len(takes) == 2, takes)
    walk.check("all is done", next_name() == "", next_name())
    yield from drop_another(walk)
    yield from correct_and_smooth(walk)
    yield from move_elsewhere(walk)


start(steps)
