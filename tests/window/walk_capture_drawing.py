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
                self.drawn.append(time.perf_counter())
                self.overlay_ms.append(1000 * (self.drawn[-1] - begin))

        kind.add, overlay.draw_capture = noted_add, noted_draw

    def clear(self) -> None:
        for times in (self.followed, self.drawn, self.overlay_ms):
            times.clear()

    def rate(self) -> float:
        """Frames a second that were followed."""
        return (len(self.followed) - 1) / (self.followed[-1] - self.followed[0])

    def drawn_meanwhile(self) -> list[float]:
        return [at for at in self.drawn if self.followed[0] <= at <= self.followed[-1]]


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
    yield from capture(walk, clock, "alone", in_window=False)
    alone = clock.rate()
    yield from capture(walk, clock, "drawn", in_window=True)
    drawn, at = clock.rate(), clock.drawn_meanwhile()
    fps = (len(at) - 1) / (at[-1] - at[0])
    slow = statistics.quantiles([b - a for a, b in itertools.pairwise(at)], n=20)[-1]
    overlay = statistics.quantiles(clock.overlay_ms, n=20)
    walk.arrays["rows"] = [
        ["capture alone, the window still", f"{alone:.1f} frames/s"],
        ["capture in the window, drawn", f"{drawn:.1f} frames/s, {drawn / alone:.0%}"],
        ["clip editor drawn meanwhile", f"{fps:.0f} times/s, 95 % within {1000 * slow:.0f} ms"],
        ["overlay of it", f"{overlay[9]:.1f} ms, 95 % within {overlay[-1]:.1f} ms"],
    ]
    walk.check("all frames were followed", len(clock.followed) == 1 + FRAMES[1] - FRAMES[0])


start(steps)
