# SPDX-License-Identifier: GPL-3.0-or-later
"""What drawing a capture at work costs it and the window: for scripts/bench_capture_drawing."""

import importlib
import itertools
import os
import random
import statistics
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, split_view, start

PACKAGE = "bl_ext.user_default.mimetic"
FRAMES = (1, 150)
EVERY = 1 / 60  # seconds after which a clip editor is asked to draw, as moving the picture would
FLOOR_SECONDS = 8.0
WANTED = 30  # drawings a second


def module(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def is_idle() -> bool:
    return module("jobs").running is None


class Clock:
    """Times at which frames were followed and at which the clip editor was drawn."""

    def __init__(self) -> None:
        self.followed, self.drawn, self.overlay_ms, self.overlay_cpu_ms = [], [], [], []
        kind = importlib.import_module("mimetic.solve.frames_so_far").FramesSoFar
        overlay = module("overlay.captured")
        add, draw = kind.add, overlay.draw_capture

        def noted_add(so_far, *inputs) -> None:
            add(so_far, *inputs)
            self.followed.append(time.perf_counter())

        def noted_draw(context) -> bool:
            begin, cpu = time.perf_counter(), time.thread_time()
            try:
                return draw(context)
            finally:
                self.overlay_cpu_ms.append(1000 * (time.thread_time() - cpu))
                self.overlay_ms.append(1000 * (time.perf_counter() - begin))

        kind.add, overlay.draw_capture = noted_add, noted_draw
        # Of its own, as the floor is drawn without the extension's
        bpy.types.SpaceClipEditor.draw_handler_add(
            lambda: self.drawn.append(time.perf_counter()), (), "WINDOW", "POST_PIXEL"
        )

    def clear(self) -> None:
        self.others = Others()
        for times in (self.followed, self.drawn, self.overlay_ms, self.overlay_cpu_ms):
            times.clear()

    def rate(self) -> float:
        """Frames a second that were followed."""
        return per_second(self.followed)

    def drawn_meanwhile(self) -> list[float]:
        return [at for at in self.drawn if self.followed[0] <= at <= self.followed[-1]]


class Others:
    """What else works on the machine: of the processors' time, from the making on."""

    def __init__(self) -> None:
        self._begin = self._times()

    @staticmethod
    def _times() -> tuple[float, float, float]:
        """Seconds of all processors, those that nobody used, and those of this process."""
        with open("/proc/stat") as stream:
            of_all = [
                int(word) / os.sysconf("SC_CLK_TCK") for word in stream.readline().split()[1:9]
            ]
        return sum(of_all), sum(of_all[3:5]), time.process_time()

    def text(self) -> str:
        total, idle, own = (b - a for a, b in zip(self._begin, self._times(), strict=True))
        return f"others {max(total - idle - own, 0.0) / total:.0%} of the processors"


def per_second(times: list[float]) -> float:
    return (len(times) - 1) / (times[-1] - times[0])


def part(kind: str) -> bpy.types.Region:
    return next(region for region in area_of("CLIP_EDITOR")[1].regions if region.type == kind)


def move_the_picture() -> None:
    """As who moves it with the mouse: the clip editor is drawn anew, and an event has come."""
    window, area = area_of("CLIP_EDITOR")
    x, y = area.x + area.width // 4, area.y + area.height // 2
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x + random.randrange(20), y=y)
    part("WINDOW").tag_redraw()


def floor(walk: Walk, name: str, draw) -> Steps:
    """What Blender takes by itself, nothing at work: draw(seconds) asks for it, again and again."""
    times, begin, cpu, others = [], time.perf_counter(), time.process_time(), Others()
    while (elapsed := time.perf_counter() - begin) < FLOOR_SECONDS:
        draw(elapsed)
        times.append(time.perf_counter())
        yield EVERY
    cpu_ms = 1000 * (time.process_time() - cpu) / len(times)
    row = f"{per_second(times):.1f} times/s, {cpu_ms:.0f} ms CPU; {others.text()}"
    walk.arrays["rows"].append([name, row])
    walk.arrays["floors"].append(per_second(times))


def floors(walk: Walk, rate: float, when: str = "") -> Steps:
    """Without anything of the extension's drawn; rate: frames a second of the capture alone."""
    walk.arrays.setdefault("floors", [])
    module("overlay").unregister()

    def go_on(seconds: float) -> None:
        frame = FRAMES[0] + int(rate * seconds)
        if bpy.context.scene.frame_current != frame:
            bpy.context.scene.frame_current = frame
        part("WINDOW").tag_redraw()

    name = f"floor {when}".strip()
    yield from floor(walk, f"{name}: a header", lambda _: part("HEADER").tag_redraw())
    yield from floor(walk, f"{name}: the picture moved", lambda _: move_the_picture())
    yield from floor(walk, f"{name}: {rate:.0f} other pictures/s", go_on)
    module("overlay").register()


def capture(walk: Walk, clock: Clock, name: str, is_asked: bool | None) -> Steps:
    """is_asked: whether the picture is drawn again and again; None: the window stands still."""
    clock.clear()
    bpy.context.scene.frame_current = 1
    options = {
        "filepath": str(walk.folder / f"{name}.npz"),
        "frame_first": FRAMES[0],
        "frame_last": FRAMES[1],
    }
    if is_asked is None:
        with bpy.context.temp_override(**override("CLIP_EDITOR")):
            bpy.ops.mimetic.capture("EXEC_DEFAULT", **options)
    else:
        invoke("CLIP_EDITOR", bpy.ops.mimetic.capture, **options)
        while not is_idle():
            if is_asked:
                move_the_picture()
            yield EVERY
    walk.check("all frames were followed", len(clock.followed) == 1 + FRAMES[1] - FRAMES[0])
    yield 0.5


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from split_view("CLIP_EDITOR")
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    yield from open_sidebar(walk, "CLIP_EDITOR", "Mimetic")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.find_face, frame=1)
    yield from walk.until(is_idle, 120, "finding the face ends")
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    clock = Clock()
    rows = walk.arrays["rows"] = []
    yield from capture(walk, clock, "alone", None)
    alone = clock.rate()
    rows.append(["capture, the window still", f"{alone:.1f} frames/s; {clock.others.text()}"])
    yield from floors(walk, alone)
    for name, is_asked in (("left alone", False), ("its picture moved", True)):
        yield from capture(walk, clock, name.replace(" ", "_"), is_asked)
        rows.append([f"capture, {name}", f"{clock.rate():.1f} frames/s; {clock.others.text()}"])
        rows += drawing(clock, walk.arrays["floors"][1])
    moved, fps = clock.rate(), per_second(clock.drawn_meanwhile())
    yield from capture(walk, clock, "alone_again", None)
    rows.append(
        [
            "capture, the window still again",
            f"{clock.rate():.1f} frames/s; {clock.others.text()}",
        ]
    )
    yield from floors(walk, alone, "again")
    rows.append(["moved against still, the mean of both", verdict(walk, moved, fps, alone, clock)])


def verdict(walk: Walk, moved: float, fps: float, alone: float, clock: Clock) -> str:
    """What the window's user gets, and what the capture keeps."""
    floor_rate = statistics.fmean(walk.arrays["floors"][1::3])
    share = moved / statistics.fmean([alone, clock.rate()])
    return (
        f"{fps:.1f} drawings/s (wanted {WANTED}; without a capture {floor_rate:.1f}), "
        f"{share:.0%} of the capture's speed (wanted 50 %)"
    )


def drawing(clock: Clock, floor_rate: float) -> list[list[str]]:
    """Rows of what was drawn while the frames were followed; floor_rate: of the picture."""
    at = clock.drawn_meanwhile()
    slow = statistics.quantiles([b - a for a, b in itertools.pairwise(at)], n=20)[-1]
    fps = per_second(at)
    overlay, cpu = (
        statistics.quantiles(ms, n=20) for ms in (clock.overlay_ms, clock.overlay_cpu_ms)
    )
    return [
        [
            "  picture drawn",
            f"{fps:.1f} times/s, {fps / floor_rate:.0%} of the floor, 95 % within "
            f"{1000 * slow:.0f} ms",
        ],
        [
            "  overlay of it",
            f"{overlay[9]:.1f} ms, 95 % within {overlay[-1]:.1f} ms; CPU {cpu[9]:.1f}, "
            f"{cpu[-1]:.1f} ms",
        ],
    ]


start(steps)
