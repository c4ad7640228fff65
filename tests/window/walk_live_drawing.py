# SPDX-License-Identifier: GPL-3.0-or-later
"""What drawing a live face costs in a window, with and without what makes it dear: for
scripts/bench_live_drawing."""

import importlib
import statistics
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
ROUNDS = 27


def is_idle() -> bool:
    return importlib.import_module(f"{PACKAGE}.jobs").running is None


def drawing_ms(is_moving: bool = True) -> float:
    """Milliseconds of drawing the 3D view, the face's sliders new each time: the quickest quarter
    at its slowest, since other work on the machine only adds to it."""
    face = bpy.context.view_layer.objects.active
    keys = face.data.shape_keys
    random = np.random.default_rng(1)
    times = []
    for _ in range(ROUNDS):
        if is_moving:
            values = random.uniform(0, 0.5, len(keys.key_blocks)).astype(np.float32)
            keys.key_blocks.foreach_set("value", values)
            keys.update_tag()
        begin = time.perf_counter()
        bpy.context.view_layer.update()
        with bpy.context.temp_override(**override("VIEW_3D")):
            bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)
        times.append(1000 * (time.perf_counter() - begin))
    return statistics.quantiles(times[3:], n=4)[0]


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    invoke("VIEW_3D", bpy.ops.mimetic.add_face)
    yield from walk.until(is_idle, 120, "adding the face ends")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_selected()
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    yield 1.0
    face = bpy.context.view_layer.objects.active
    space = area_of("VIEW_3D")[1].spaces.active
    system, modifier = bpy.context.preferences.system, face.modifiers["Subdivision"]
    rows = {}

    def measure(name: str, **words: bool) -> None:
        rows[name] = drawing_ms(**words)
        print(f"walk: {name}: {rows[name]:.0f} ms", flush=True)

    measure("subdivided, at rest", is_moving=False)
    measure("subdivided")
    modifier.show_viewport = False
    measure("not subdivided")
    aa, system.viewport_aa = system.viewport_aa, "OFF"
    measure("nor anti-aliased")
    space.overlay.show_overlays = False
    measure("nor overlays")
    space.shading.show_object_outline = False
    measure("nor outline")
    shading, before = space.shading, space.shading.light
    shading.light = "FLAT"
    measure("nor lit")
    shading.light = before
    face.hide_set(True)
    measure("nor the face")
    measure("nor anything that moves", is_moving=False)
    face.hide_set(False)
    shading.show_object_outline = space.overlay.show_overlays = True
    modifier.show_viewport, system.viewport_aa = True, aa
    measure("all of it again")
    fast = importlib.import_module(f"{PACKAGE}.fast_view").FastView(face)
    measure("Fast View")
    fast.end()
    measure("after Fast View")
    walk.arrays["rows"] = [[name, f"{ms:6.0f} ms"] for name, ms in rows.items()]
    walk.check("all was drawn", min(rows.values()) > 0)


start(steps)
