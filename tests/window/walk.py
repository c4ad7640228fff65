# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: steps a walk (a generator) by a timer, and writes what it found.

A walk yields seconds to wait, or nothing to go on at once. It may use `yield from` on `picture` and
`until`. Its checks go to result.json, which appears whole and only when the walk is over.
"""

from __future__ import annotations

import json
import sys
import time
import traceback
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import bpy

Steps = Generator[float | None, None, Any]


class Walk:
    """What a walk is given: where its files are, and where its findings go."""

    def __init__(self, folder: Path, settings: dict) -> None:
        self.folder = folder
        self.settings = settings
        self.checks: list[dict] = []
        self.arrays: dict[str, list] = {}

    def check(self, claim: str, holds: bool, found: object = "") -> None:
        self.checks.append({"claim": claim, "holds": bool(holds), "found": str(found)})
        print(f"walk: {'ok' if holds else 'FAILED'}: {claim} {found}", flush=True)

    def until(
        self,
        condition: Callable[[], bool],
        seconds: float,
        claim: str,
        hindrance: Callable[[], str] = str,
    ) -> Steps:
        """Wait until the condition holds; that it does within the time is a check of its own.

        hindrance: says what it waits for still.
        """
        start = time.monotonic()
        while not condition():
            if time.monotonic() - start > seconds:
                self.check(claim, False, f"not within {seconds:g} s {hindrance()}".rstrip())
                return
            yield 0.1
        self.check(claim, True, f"after {time.monotonic() - start:.1f} s")

    def picture(self, name: str) -> Steps:
        """Have the test outside photograph the screen: Blender's own is black in a timer."""
        yield 0.5  # let the last change be drawn
        request = self.folder / f"{name}.request"
        request.touch()
        yield from self.until(lambda: not request.exists(), 30, f"picture {name} was taken")

    def ask(self, name: str, content: str = "") -> Steps:
        """Have the test outside do what only the screen's user can: see `_serve` there."""
        aside, request = self.folder / f"{name}.partial", self.folder / name
        aside.write_text(content)
        aside.replace(request)
        yield from self.until(lambda: not request.exists(), 30, f"{name} was done")

    def close(self) -> None:
        aside = self.folder / "result.partial"
        aside.write_text(json.dumps({"checks": self.checks, "arrays": self.arrays}))
        aside.replace(self.folder / "result.json")


def area_of(kind: str) -> tuple[bpy.types.Window, bpy.types.Area]:
    """The first area of a kind in the window, for example 'VIEW_3D'."""
    window = bpy.context.window_manager.windows[0]
    return window, next(area for area in window.screen.areas if area.type == kind)


def override(kind: str) -> dict:
    """Context for an operator that is called as from the main region of an area."""
    window, area = area_of(kind)
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region}


def invoke(kind: str, operator: Callable, **properties: object) -> set[str]:
    """Start an operator as a button in an area's main region does."""
    with bpy.context.temp_override(**override(kind)):
        return operator("INVOKE_DEFAULT", **properties)


def press(kind: str, key: str) -> None:
    """Press and release a key with the mouse over the middle of an area."""
    window, area = area_of(kind)
    x, y = area.x + area.width // 2, area.y + area.height // 2
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type=key, value=value, x=x, y=y)


def split_view(kind: str, factor: float = 0.5) -> Steps:
    """Make the right part of the 3D view an editor of a kind; factor: the left part's share."""
    window, view = area_of("VIEW_3D")
    with bpy.context.temp_override(window=window, area=view):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=factor)
    yield 0.3
    views = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    max(views, key=lambda area: area.x).type = kind
    yield 0.5


def install(walk: Walk, package: str) -> Steps:
    """Install the extension's zip as a user does, from disk."""
    bpy.ops.extensions.package_install_files(
        filepath=str(walk.folder / walk.settings["extension"]),
        repo="user_default",
        enable_on_install=True,
    )
    yield 0.5
    walk.check("the extension is enabled", package in bpy.context.preferences.addons)


def strip_columns(kind: str, frames: list[float]) -> list[list[int]]:
    """Where an editor of time shows the quality of scene frames: x, and between which y, in the
    window."""
    region = override(kind)["region"]
    top = region.y + region.height
    return [
        [region.x + region.view2d.view_to_region(frame, 0, clip=False)[0], top - 30, top - 12]
        for frame in frames
    ]


def open_sidebar(walk: Walk, kind: str, category: str) -> Steps:
    """Show a sidebar with a category's tab; the tab exists only after a first drawing."""
    _, area = area_of(kind)
    area.spaces.active.show_region_ui = True
    yield 0.5
    sidebar = next(region for region in area.regions if region.type == "UI")
    area.tag_redraw()
    yield 0.5
    try:
        sidebar.active_panel_category = category
        walk.check(f"{kind} has the tab {category}", sidebar.active_panel_category == category)
    except (AttributeError, TypeError) as reason:
        walk.check(f"{kind} has the tab {category}", False, reason)


def rest() -> float:
    """Between events Blender sleeps as long, but not where it simulates them: there its loop keeps
    a whole processor busy, half of what two tests side by side have."""
    time.sleep(0.005)
    return 0.0


def start(steps: Callable[[Walk], Steps]) -> None:
    """Step the walk by a timer until it ends, then write the findings and leave Blender."""
    bpy.context.preferences.view.show_splash = False
    folder = Path(sys.argv[sys.argv.index("--") + 1])
    walk = Walk(folder, json.loads((folder / "settings.json").read_text()))
    running = steps(walk)

    def step() -> float | None:
        try:
            return next(running) or 0.01
        except StopIteration:
            pass
        except Exception:  # whatever went wrong is a finding, and Blender must close
            walk.check("the walk ended without an exception", False, traceback.format_exc())
        walk.close()
        bpy.ops.wm.quit_blender()
        return None

    # Persistent: a walk may open a file
    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
    bpy.app.timers.register(rest, persistent=True)
