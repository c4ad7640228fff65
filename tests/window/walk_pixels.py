# SPDX-License-Identifier: GPL-3.0-or-later
"""A quarter's proxies on show, or pixels that are not square: a capture is the same afterwards, and
a click means the skin that is seen there."""

import importlib
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, override, start

PACKAGE = "bl_ext.user_default.mimetic"


def module(name: str):
    return importlib.import_module(f"{PACKAGE}.{name}")


def is_idle() -> bool:
    return module("jobs").running is None


def capture(walk: Walk, name: str) -> Steps:
    path = str(walk.folder / f"{name}.npz")
    invoke("CLIP_EDITOR", bpy.ops.mimetic.capture, filepath=path)
    yield from walk.until(is_idle, 120, f"the capture {name} ends")
    return importlib.import_module("mimetic.performance.document").Performance.load(path)


def show_proxies(walk: Walk) -> Steps:
    clip = bpy.context.scene.mimetic.clip
    space = area_of("CLIP_EDITOR")[1].spaces.active
    clip.use_proxy = clip.proxy.build_25 = True
    invoke("CLIP_EDITOR", bpy.ops.clip.rebuild_proxy)
    folder = walk.folder / "BL_proxy"
    yield from walk.until(lambda: any(folder.rglob("*25*")), 30, "proxies are made")
    yield 2.0
    space.clip_user.proxy_render_size = "PROXY_25"
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.reload()
        bpy.ops.screen.frame_offset(delta=1)
    yield 1.0


def mouse(kind: str, value: str, x: float, y: float) -> None:
    window, _ = area_of("CLIP_EDITOR")
    window.event_simulate(type=kind, value=value, x=round(x), y=round(y))


def pin(walk: Walk, performance) -> Steps:
    """The nose's tip, where the window shows it: left and down by some pixels of the screen."""
    region = next(part for part in area_of("CLIP_EDITOR")[1].regions if part.type == "WINDOW")
    i = bpy.context.scene.frame_current - 1
    template = importlib.import_module("mimetic.template.face_template").load_template()
    tip = performance.project(performance.surface_in_camera(i))[template.landmark("nose_tip")]
    share = (tip + 0.5) / performance.image_size
    invoke("CLIP_EDITOR", bpy.ops.mimetic.pin_skin)
    yield 0.3
    x, y = region.view2d.view_to_region(share[0], 1 - share[1], clip=False)
    place = region.x + x, region.y + y
    for kind, value in (
        *(("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS")),
        *(("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "RELEASE")),
    ):
        mouse(kind, value, *place)
        yield 0.5
    entries = module("corrections").of_clip(bpy.context.scene.mimetic.clip)
    pixels = [pin.pixel for entry in entries for pin in entry.pins]
    off = [np.abs(np.subtract(pixel, tip)).max() for pixel in pixels]
    is_there = len(off) == 1 and off[0] < 0.7
    walk.check("a click is where the skin is", is_there, f"{pixels}, not {tip}, at {place}")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    area_of("VIEW_3D")[1].type = "CLIP_EDITOR"
    yield 0.5
    area_of("CLIP_EDITOR")[1].spaces.active.show_region_toolbar = False
    bpy.ops.mimetic.load_clip(filepath=str(walk.folder / walk.settings["clip"]))
    bpy.ops.mimetic.find_face(frame=1)
    before = yield from capture(walk, "before")
    if walk.settings["is_proxied"]:
        yield from show_proxies(walk)
    after = yield from capture(walk, "after")
    same = all(
        np.array_equal(getattr(before, name), getattr(after, name))
        for name in ("activations", "head_pose", "image_size")
    )
    walk.check("the capture is the same", same)
    with bpy.context.temp_override(**override("CLIP_EDITOR")):
        bpy.ops.clip.view_all(fit_view=True)
    yield 0.5
    yield from pin(walk, after)
    yield from walk.picture(f"pixels-{walk.settings['name']}")


start(steps)
