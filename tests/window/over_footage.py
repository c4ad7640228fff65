# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: the mouse over the footage, and what it corrects."""

import importlib

import bpy
import numpy as np
from walk import Steps, area_of, override

PACKAGE = "bl_ext.user_default.mimetic"
MOVES = 8  # of the mouse in a drag


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


def entry_at(frame: int):
    return next((entry for entry in kept() if entry.frame == frame), None)


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
