# SPDX-License-Identifier: GPL-3.0-or-later
"""A landmark is dragged by the screen's own mouse on a head with muscles, which follow by
themselves; undo, redo and Esc leave what was, and nothing follows them."""

import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Quaternion, Vector

sys.path.insert(0, str(Path(__file__).parent))
import redo_scenes as scenes
from undoing import PACKAGE, module, on_screen, press
from walk import Steps, Walk, area_of, install, open_sidebar, override, start

TRIES = 3
STILL = 0.8  # seconds without a job after which none begins
NAMES = ("update undone", "drag undone", "drag redone", "update redone")
NUM_UNITS = 52
SMILE, SHARE = "zygomaticus_major.L", 0.5


def head() -> bpy.types.Object:
    return bpy.data.objects["Bust"]


def mark() -> bpy.types.Object:
    return next(one for one in head().children if one.mimetic.landmark == "chin")


def offsets() -> np.ndarray:
    """Of all muscles' keys and ARKit's shapes, one after another."""
    keys, rows = head().data.shape_keys, []
    for shape in (*head().mimetic.shapes, *head().mimetic.units):
        points = np.empty(3 * len(head().data.vertices), dtype=np.float32)
        keys.key_blocks[shape.name].points.foreach_get("co", points)
        rows.append(points)
    return np.array(rows)


def state() -> tuple:
    """Where the chin's landmark is, whether the button is lit, and what the muscles do."""
    window, area = area_of("VIEW_3D")
    with bpy.context.temp_override(window=window, area=area):
        is_lit = module("next_step").of(bpy.context).operator == "mimetic.attach_muscles"
    return round(mark().location[2], 5), is_lit, offsets()


def is_same(one: tuple, other: tuple) -> bool:
    return one[:2] == other[:2] and np.array_equal(one[2], other[2])


def is_idle() -> bool:
    return module("jobs").running is None


def soon(condition: Callable[[], bool], seconds: float) -> Steps:
    """Waits so long at most for what may well not become true."""
    for _ in range(round(10 * seconds)):
        if condition():
            return
        yield 0.1


def drag(walk: Walk, name: str, pixels: int, is_held: bool = False) -> Steps:
    """Presses on the landmark and draws it down by so many pixels.

    Where a slow screen has not drawn the view yet, the press meets nothing; as a user would, it
    is then tried again.
    """
    is_dragging = module("editors").is_dragging
    for i in range(TRIES):
        area, region = area_of("VIEW_3D")[1], override("VIEW_3D")["region"]
        place = mark().matrix_world.translation
        x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, place)
        x, y = on_screen(region.x + x, region.y + y)
        words = f"mousemove {x} {y - 3} sleep 0.2 mousemove {x} {y} sleep 0.3 mousedown 1 sleep 0.3"
        for share in (0.3, 0.6, 1):
            words += f" mousemove {x} {y + round(share * pixels)} sleep 0.2"
        yield from walk.ask(f"{name}-{i}.act", words)
        yield from soon(is_dragging, 2)
        if is_dragging():
            break
        yield from walk.picture(f"{name}-{i}-missed")
        yield from walk.ask(f"{name}-{i}-let-go.act", "mouseup 1")
    where = f"at {x}, {y} after {i + 1} tries, selected: {bpy.context.selected_objects}"
    walk.check(f"{name}: the landmark is dragged", is_dragging(), where)
    if not is_held:
        yield from walk.ask(f"{name}-let-go.act", "mouseup 1")


def nothing_begins(walk: Walk, claim: str) -> Steps:
    yield from soon(lambda: not is_idle(), STILL)
    walk.check(claim, is_idle())


def prepared(walk: Walk) -> Steps:
    """The head from the front, its sliders beside it, one of them moved."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.context.view_layer.update()
    scenes.landmarks(walk)
    scenes.run(walk, "attach_muscles")
    scenes.run(walk, "add_arkit_shapes")
    head().data.shape_keys.key_blocks[SMILE].value = SHARE
    head().hide_select = True  # the press means the landmark on it
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    view = area_of("VIEW_3D")[1].spaces.active.region_3d
    view.view_perspective, view.view_distance = "ORTHO", 0.45
    view.view_rotation = Quaternion((0.7071068, 0.7071068, 0, 0))
    view.view_location = head().matrix_world.translation + Vector((0.04, 0, 0))
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.wm.tool_set_by_id(name="builtin.select")
        bpy.ops.ed.undo_push(message="attached")
    yield 0.5


def follow(walk: Walk) -> Steps:
    attached = state()
    yield from drag(walk, "dragged-chin", 30, is_held=True)
    yield from walk.picture("dragged-held")
    yield from nothing_begins(walk, "no job begins while the landmark is held still")
    walk.check("but it has moved", state()[0] < attached[0] - 0.002, state()[0])
    yield from walk.ask("dragged-let-go.act", "mouseup 1")
    yield from walk.until(lambda: not is_idle(), 5, "the job begins when it is let go")
    dragged = state()
    walk.check("the button is lit until it is done", dragged[1])
    yield from walk.picture("dragged-follows")
    yield from walk.until(is_idle, 20, "the job ends")
    yield from nothing_begins(walk, "and none begins after it")
    followed = state()
    change = np.abs(followed[2] - attached[2]).max()
    walk.check("the muscles' keys have changed", change > 1e-4, f"{change:.5f} m")
    change = np.abs(followed[2] - attached[2])[-NUM_UNITS:].max()
    walk.check("ARKit's shapes have changed", change > 1e-4, f"{change:.5f} m")
    walk.check("nothing is lit", not followed[1])
    value = head().data.shape_keys.key_blocks[SMILE].value
    walk.check("sliders stay where they are", abs(value - SHARE) < 1e-6, value)
    yield from walk.picture("dragged-followed")
    return attached, dragged, followed


def undo_and_redo(walk: Walk, attached: tuple, dragged: tuple, followed: tuple) -> Steps:
    for i, (key, wanted) in enumerate(
        (
            ("ctrl+z", dragged),
            ("ctrl+z", attached),
            ("ctrl+shift+z", dragged),
            ("ctrl+shift+z", followed),
        )
    ):
        name = NAMES[i]
        yield from press(walk, f"dragged-{i}", "VIEW_3D", key)
        yield from walk.until(lambda w=wanted: is_same(state(), w), 10, name)
        yield from nothing_begins(walk, f"{name}: nothing follows")
        walk.check(f"{name}: and so it stays", is_same(state(), wanted))
        if i == 0:
            yield from walk.picture("dragged-update-undone")


def drag_on_and_stop(walk: Walk) -> Steps:
    before = state()
    yield from drag(walk, "dragged-again", -24)
    yield from walk.until(lambda: not is_idle(), 5, "another drag is followed")
    first = module("jobs").running
    yield from drag(walk, "dragged-on", 16)
    yield from walk.until(
        lambda: module("jobs").running not in (None, first), 10, "a drag meanwhile begins it anew"
    )
    walk.check("the first one was stopped", first.stop.is_set())
    yield from press(walk, "dragged-esc", "VIEW_3D", "Escape")
    yield from walk.until(is_idle, 10, "Esc stops it")
    yield from nothing_begins(walk, "and it does not begin again")
    now = state()
    walk.check("the muscles are as before, and lit", np.array_equal(now[2], before[2]) and now[1])
    yield from walk.picture("dragged-stopped")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from prepared(walk)
    states = yield from follow(walk)
    yield from undo_and_redo(walk, *states)
    yield from drag_on_and_stop(walk)


start(steps)
