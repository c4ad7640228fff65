# SPDX-License-Identifier: GPL-3.0-or-later
"""What drawing a capture at work costs it and the window: for scripts/bench_capture_drawing."""

import importlib
import itertools
import statistics
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
FRAMES = (1, 150)
EVERY = 1 / 60  # seconds after which a clip editor is asked to draw, as playing would
FLOOR_SECONDS = 8.0


def module(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def is_idle() -> bool:
    return module("jobs").running is None


class Clock:
    """Times at which frames were followed and at which the clip editor was drawn."""

    def __init__(self) -> None:
        self.followed, self.drawn, self.overlay_ms = [], [], []
        kind = importlib.import_module("mimetic.solve.frames_so_far").FramesSoFar
        overlay = module("overlay.captured")
        add, draw = kind.add, overlay.draw_capture

        def noted_add(so_far, *inputs) -> None:
            add(so_far, *inputs)
            self.followed.append(time.perf_counter())

        def noted_draw(context) -> bool:
            begin = time.perf_counter()
            try:
                return draw(context)
            finally:
                self.overlay_ms.append(1000 * (time.perf_counter() - begin))

        kind.add, overlay.draw_capture = noted_add, noted_draw
        # Of its own, as the floor is drawn without the extension's
        bpy.types.SpaceClipEditor.draw_handler_add(
            lambda: self.drawn.append(time.perf_counter()), (), "WINDOW", "POST_PIXEL"
        )

    def clear(self) -> None:
        for times in (self.followed, self.drawn, self.overlay_ms):
            times.clear()

    def rate(self) -> float:
        """Frames a second that were followed."""
        return per_second(self.followed)

    def drawn_meanwhile(self) -> list[float]:
        return [at for at in self.drawn if self.followed[0] <= at <= self.followed[-1]]


def draw_without(walk: Walk, clock: Clock, rate: float) -> Steps:
    """Floors: Blender's own clip editor, nothing at work, its playhead `rate` frames a second."""
    clock.clear()
    scene, begin, cpu = bpy.context.scene, time.perf_counter(), time.process_time()
    while (elapsed := time.perf_counter() - begin) < FLOOR_SECONDS:
        frame = FRAMES[0] + int(rate * elapsed)
        if scene.frame_current != frame:
            scene.frame_current = frame
        area_of("CLIP_EDITOR")[1].tag_redraw()
        yield EVERY
    cpu_ms = 1000 * (time.process_time() - cpu) / max(len(clock.drawn), 1)
    name = f"no extension, {rate:.0f} other pictures/s" if rate else "no extension, one picture"
    found = f"{per_second(clock.drawn):.0f} times/s, {cpu_ms:.0f} ms CPU"
    walk.arrays["rows"].append([name, found])


def per_second(times: list[float]) -> float:
    return (len(times) - 1) / (times[-1] - times[0])


def capture(walk: Walk, clock: Clock, name: str, in_window: bool) -> Steps:
    clock.clear()
    options = {
        "filepath": str(walk.folder / f"{name}.npz"),
        "frame_first": FRAMES[0],
        "frame_last": FRAMES[1],
    }
    if in_window:
        invoke("CLIP_EDITOR", bpy.ops.mimetic.capture, **options)
        while not is_idle():
            area_of("CLIP_EDITOR")[1].tag_redraw()
            yield EVERY
    else:
        with bpy.context.temp_override(**override("CLIP_EDITOR")):
            bpy.ops.mimetic.capture("EXEC_DEFAULT", **options)
    yield 0.5


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    window, view = area_of("VIEW_3D")
    with bpy.context.temp_override(window=window, area=view):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield 0.3
    views = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    max(views, key=lambda area: area.x).type = "CLIP_EDITOR"
    yield 0.5
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    yield from open_sidebar(walk, "CLIP_EDITOR", "Mimetic")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.find_face, frame=1)
    yield from walk.until(is_idle, 120, "finding the face ends")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    clock = Clock()
    rows = walk.arrays["rows"] = []
    yield from capture(walk, clock, "alone", in_window=False)
    alone = clock.rate()
    rows.append(["capture alone, the window still", f"{alone:.1f} frames/s"])
    module("overlay").unregister()
    yield from draw_without(walk, clock, 0)
    yield from draw_without(walk, clock, alone)
    floor = per_second(clock.drawn)
    module("overlay").register()
    yield from capture(walk, clock, "drawn", in_window=True)
    drawn, at = clock.rate(), clock.drawn_meanwhile()
    fps = per_second(at)
    slow = statistics.quantiles([b - a for a, b in itertools.pairwise(at)], n=20)[-1]
    overlay = statistics.quantiles(clock.overlay_ms, n=20)
    rows += [
        ["capture in the window, drawn", f"{drawn:.1f} frames/s, {drawn / alone:.0%} of alone"],
        [
            "clip editor drawn meanwhile",
            f"{fps:.0f} times/s, {fps / floor:.0%} of the floor, 95 % within {1000 * slow:.0f} ms",
        ],
        ["overlay of it", f"{overlay[9]:.1f} ms, 95 % within {overlay[-1]:.1f} ms"],
    ]
    walk.check("all frames were followed", len(clock.followed) == 1 + FRAMES[1] - FRAMES[0])


start(steps)
