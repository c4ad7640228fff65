# SPDX-License-Identifier: GPL-3.0-or-later
"""Two takes of a face: curves edited in the panel, a clip baked again, side by side, blended."""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).parent))
from walk import (
    Steps,
    Walk,
    area_of,
    install,
    invoke,
    open_sidebar,
    override,
    start,
    strip_columns,
)
from walk import press as press_key

PACKAGE = "bl_ext.user_default.mimetic"
LEFT, RIGHT = "zygomaticus_major.L", "zygomaticus_major.R"
SHOWN = ("MIMETIC_PT_takes", "MIMETIC_PT_curves", "MIMETIC_PT_muscles")


def is_idle() -> bool:
    return sys.modules[f"{PACKAGE}.jobs"].running is None


def result() -> dict:
    return json.loads(bpy.context.window_manager.mimetic_result)


def face() -> bpy.types.Object:
    return bpy.context.scene.mimetic.face


def playing() -> str:
    row = sys.modules[f"{PACKAGE}.scene_out"].take_list.playing(face())
    return row.name if row else ""


def values(name: str) -> np.ndarray:
    rows = sys.modules[f"{PACKAGE}.scene_out"].face_curves.of(face())
    curve = next(row.curve for row in rows if row.shape == name)
    return np.array([point.co.y for point in curve.keyframe_points])


def roughness(name: str) -> float:
    return float(np.abs(np.diff(values(name), n=2)).mean())


def show_the_panels(walk: Walk) -> Steps:
    """Only those that this is about, opened: the sidebar is not as high as all of them."""
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    panels = sys.modules[f"{PACKAGE}.panels"].CLASSES
    for panel in reversed(panels):
        if issubclass(panel, bpy.types.Panel) and panel.bl_space_type == "VIEW_3D":
            bpy.utils.unregister_class(panel)
    for panel in panels:
        if panel.__name__ in SHOWN[:2]:
            panel.bl_options = set()
            bpy.utils.register_class(panel)
    yield 0.5


def bring_the_panels_back() -> None:
    """The extension takes all of them away when it ends."""
    for panel in sys.modules[f"{PACKAGE}.panels"].CLASSES:
        if not panel.is_registered:
            bpy.utils.register_class(panel)


def bake(walk: Walk, name: str, **options: object) -> Steps:
    bpy.context.scene.mimetic.performance_path = str(walk.folder / f"{name}.performance.npz")
    invoke("VIEW_3D", bpy.ops.mimetic.bake, **options)
    yield from walk.until(is_idle, 120, f"the bake of {name} ends")


def press(operator, **options: object) -> None:
    """As a button: with a step for undo."""
    with bpy.context.temp_override(**override("VIEW_3D")):
        operator("INVOKE_DEFAULT", True, **options)


def is_in_view(obj: bpy.types.Object) -> bool:
    """Whole, and at least a tenth of the 3D view high."""
    place = override("VIEW_3D")
    region, view = place["region"], place["area"].spaces.active.region_3d
    corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box]
    pixels = np.array([location_3d_to_region_2d(region, view, corner) for corner in corners])
    size = np.array([region.width, region.height])
    is_inside = bool((pixels > 0).all() and (pixels < size).all())
    return is_inside and np.ptp(pixels[:, 1]) > 0.1 * region.height


def edit_the_curves(walk: Walk) -> Steps:
    before = roughness(LEFT), values(LEFT).max(), values(RIGHT).max()
    press(bpy.ops.mimetic.smooth_curves, seconds=0.08)
    yield 0.3
    walk.check("smoothing takes jitter away", roughness(LEFT) < 0.4 * before[0], roughness(LEFT))
    walk.check("and leaves the smile", values(LEFT).max() > 0.9 * before[1], values(LEFT).max())
    press(bpy.ops.mimetic.mirror_curves, how="LEFT", group="Lip Corners")
    walk.check("both corners smile alike", np.abs(values(LEFT) - values(RIGHT)).max() < 1e-6)
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.ed.undo()
    yield 0.3
    walk.check("one undo takes the mirror back", values(RIGHT).max() < 0.7, values(RIGHT).max())
    walk.check("and no more", roughness(LEFT) < 0.4 * before[0])
    yield from walk.picture("curves")


def work_on_takes(walk: Walk) -> Steps:
    yield from bake(walk, "again")
    walk.check("the edited take is kept", "hero was edited" in result()["message"], result())
    walk.check("the new one plays", playing() == "again", playing())
    marks = [marker.frame for marker in bpy.context.scene.timeline_markers]
    walk.check("lost frames are marked", sorted(marks) == [37, 49], marks)
    yield from show_the_strip(walk)
    bpy.context.scene.frame_set(12)
    yield from walk.picture("takes")
    invoke("VIEW_3D", bpy.ops.mimetic.compare_take, take="hero")
    bpy.context.scene.frame_set(12)
    seen = [is_in_view(obj) for obj in (face(), bpy.data.objects[result()["copy"]])]
    walk.check("both faces are in view, large enough", all(seen), seen)
    yield from walk.picture("takes-compared")
    bpy.data.objects.remove(bpy.data.objects[result()["copy"]])
    invoke("VIEW_3D", bpy.ops.mimetic.blend_takes, take="hero", over="again", influence=0.5)
    bpy.context.view_layer.objects.active = face()
    area_of("DOPESHEET_EDITOR")[1].ui_type = "NLA_EDITOR"
    yield from walk.picture("takes-blended")
    invoke("VIEW_3D", bpy.ops.mimetic.play_take, take="hero")
    walk.check("a take plays alone again", playing() == "hero", playing())


def show_the_strip(walk: Walk) -> Steps:
    """Of quality, in each editor of time; the test outside looks at its pixels."""
    bpy.context.scene.frame_set(70)
    bpy.context.view_layer.objects.active = face()
    area = area_of("DOPESHEET_EDITOR")[1]
    for kind in ("TIMELINE", "DOPESHEET", "FCURVES"):
        area.ui_type = kind
        yield 0.5
        if kind == "FCURVES":
            with bpy.context.temp_override(**override(area.type)):
                bpy.ops.graph.view_all()
            yield 0.5
        walk.arrays[f"strip-{kind}"] = strip_columns(area.type, walk.settings["looked_at"])
        yield from walk.picture(f"strip-{kind}")
    yield from time_the_strip(walk)
    bpy.context.scene.mimetic.show_quality = False
    yield from walk.picture("strip-off")
    bpy.context.scene.mimetic.show_quality = True
    area.ui_type = "TIMELINE"
    yield from show_error_bars(walk)


def show_error_bars(walk: Walk) -> Steps:
    """About one selected curve; the test outside looks at their pixels."""
    rows = sys.modules[f"{PACKAGE}.scene_out"].face_curves.of(face())
    for row in rows:
        row.curve.select = row.shape == LEFT
    bpy.context.scene.frame_set(64)
    area = area_of("VIEW_3D")[1]
    area.ui_type = "FCURVES"
    yield 0.5
    yield from open_sidebar(walk, "GRAPH_EDITOR", "Mimetic")
    curve = next(row.curve for row in rows if row.shape == LEFT)
    low, high = min(values(LEFT)), max(values(LEFT))
    for name, middle, half in (("", 0, 1), ("-normalized", (low + high) / 2, (high - low) / 2)):
        area.spaces.active.use_normalization = bool(name)
        with bpy.context.temp_override(**override("GRAPH_EDITOR")):
            bpy.ops.graph.view_selected()
        yield from walk.picture(f"error-bars{name}")
        region = override("GRAPH_EDITOR")["region"]
        walk.arrays[f"error-bars{name}"] = [
            pixel_of(region, frame, (curve.evaluate(frame) + beside - middle) / half)
            for frame in walk.settings["with_bars"]
            for beside in (-0.3, -0.1, 0.1, 0.3)
        ]
        bpy.context.scene.mimetic.show_error_bars = False
        yield from walk.picture(f"error-bars{name}-off")
        bpy.context.scene.mimetic.show_error_bars = True
    area.spaces.active.use_normalization = False
    yield from time_drawing(walk, "error_bars", "draw_bands", 5)
    area.ui_type = "VIEW_3D"
    yield 0.5


def pixel_of(region: bpy.types.Region, frame: float, value: float) -> list[float]:
    """Of the window, where an editor has a place, also beyond what it shows."""
    x, y = region.view2d.view_to_region(frame, value, clip=False)
    return [region.x + x, region.y + y]


def time_the_strip(walk: Walk) -> Steps:
    yield from time_drawing(walk, "timeline", "draw_strip", 3)


def time_drawing(walk: Walk, module: str, function: str, limit: float) -> Steps:
    """In the Graph Editor, of the processor: others may work on the machine."""
    draw, taken = getattr(sys.modules[f"{PACKAGE}.overlay.{module}"], function), []

    def measure() -> None:
        begin = time.thread_time()
        for _ in range(50):
            draw()
        taken.append(1000 * (time.thread_time() - begin) / 50)

    space = bpy.types.SpaceGraphEditor
    handle = space.draw_handler_add(measure, (), "WINDOW", "POST_PIXEL")
    area_of("GRAPH_EDITOR")[1].tag_redraw()
    yield 1.0
    space.draw_handler_remove(handle, "WINDOW")
    in_time = bool(taken) and min(taken) < limit
    walk.check(f"{function} takes {limit} ms at most", in_time, taken)


def preview_a_table(walk: Walk) -> Steps:
    """A key of the character's own shows the take at the scene's frame until Esc."""
    head, preview = face(), sys.modules[f"{PACKAGE}.control_preview"]
    own, like = head.shape_key_add(name="Grin", from_mix=False), head.data.shape_keys
    points = np.empty(3 * len(own.points), dtype=np.float32)
    like.key_blocks[LEFT].points.foreach_get("co", points)
    own.points.foreach_set("co", points)
    own.value = 0.0
    bpy.context.view_layer.objects.active = head
    invoke("VIEW_3D", bpy.ops.mimetic.preview_controls)
    yield from walk.until(lambda: preview.active is not None, 60, "the preview begins")
    shown = {}
    for frame in range(1, 37):
        bpy.context.scene.frame_set(frame)
        shown[frame] = own.value
    widest = max(shown, key=shown.get)
    walk.check("the key follows the take", shown[widest] > 0.3, shown[widest])
    bpy.context.scene.frame_set(widest)
    head.mimetic.controls["Grin"].gain = 0.5
    share = own.value / shown[widest]
    walk.check("an edited row shows at once", abs(share - 0.5) < 1e-3, share)
    press_key("VIEW_3D", "ESC")
    yield from walk.until(lambda: preview.active is None, 20, "Esc ends it")
    walk.check("the key is as it was", own.value == 0, own.value)
    walk.check("nothing is keyed", "Grin" not in str([c.data_path for c in curves(head)]))


def curves(head) -> list:
    holder = sys.modules[f"{PACKAGE}.compat"].curves(head.data.shape_keys)
    return list(holder.fcurves) if holder else []


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.context.scene.render.fps = 25
    yield from bake(walk, "hero")
    walk.check("a row is in the list", [row.name for row in face().mimetic.takes] == ["hero"])
    yield from show_the_panels(walk)
    yield from edit_the_curves(walk)
    yield from work_on_takes(walk)
    yield from preview_a_table(walk)
    bring_the_panels_back()


start(steps)
