# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions in a window: shown by their pictures, blended by dragging, put in the NLA; and the
panel of the curves."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
SMILE = "zygomaticus_major.L"
PANELS = {"capture": True, "muscles": True, "head": True, "curves": False, "expressions": False}


def is_idle() -> bool:
    return sys.modules[f"{PACKAGE}.jobs"].running is None


def face() -> bpy.types.Object:
    return bpy.data.objects["Face"]


def value() -> float:
    return face().data.shape_keys.key_blocks[SMILE].value


def move_to(part: float) -> None:
    """The mouse to a part of the 3D view's width."""
    window, area = area_of("VIEW_3D")
    place = {"x": area.x + int(part * area.width), "y": area.y + area.height // 2}
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", **place)


def press(key: str) -> None:
    window, area = area_of("VIEW_3D")
    place = {"x": area.x + area.width // 2, "y": area.y + area.height // 2}
    for press_or_release in ("PRESS", "RELEASE"):
        window.event_simulate(type=key, value=press_or_release, **place)


def open_panels() -> None:
    """As if their headers had been clicked on: what is open is no setting that a script reaches."""
    for name, is_closed in PANELS.items():
        classes = sys.modules[f"{PACKAGE}.panels.{name}"].CLASSES
        for cls in reversed(classes):
            bpy.utils.unregister_class(cls)
        for cls in classes:
            if not hasattr(cls, "bl_parent_id"):
                cls.bl_options = {"DEFAULT_CLOSED"} if is_closed else set()
            bpy.utils.register_class(cls)


def prepare(walk: Walk) -> Steps:
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    open_panels()
    invoke("VIEW_3D", bpy.ops.mimetic.add_face)
    yield from walk.until(is_idle, 120, "adding the face ends")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_selected()
        bpy.ops.view3d.view_axis(type="FRONT")
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    folder = str(walk.folder / "library")
    invoke("VIEW_3D", bpy.ops.mimetic.load_expressions, directory=folder)
    yield from walk.until(is_idle, 120, "loading the library ends")
    names = sorted(action.name for action in bpy.data.actions if action.asset_data)
    walk.check("the library's expressions are assets", names == ["brows", "smile"], names)
    bpy.context.scene.mimetic.expression = bpy.data.actions["smile"]


def blend_by_dragging(walk: Walk) -> Steps:
    move_to(0.3)
    yield 0.3
    invoke("VIEW_3D", bpy.ops.mimetic.apply_expression)
    yield 0.3
    move_to(0.42)
    yield 0.5
    half = value()
    walk.check("a drag half-way blends half-way", 0.1 < half < 0.75, f"{half:.2f}")
    yield from walk.picture("expression-dragged")
    move_to(0.95)
    yield 0.5
    walk.check("a drag to the end is the expression", abs(value() - 0.8) < 0.02, f"{value():.2f}")
    press("ESC")
    yield 0.5
    walk.check("Esc leaves the face as it was", value() == 0.0, value())
    move_to(0.3)
    yield 0.3
    invoke("VIEW_3D", bpy.ops.mimetic.apply_expression)
    yield 0.3
    move_to(0.95)
    yield 0.3
    press("RET")
    yield 0.5
    walk.check("Return keeps it", abs(value() - 0.8) < 0.02, f"{value():.2f}")
    bpy.ops.ed.undo()
    yield 0.5
    walk.check("undo takes it back in one step", value() == 0.0, value())


def look_at_the_assets(walk: Walk) -> Steps:
    """The properties' editor, which is tall, as an Asset Browser of this file."""
    window, area = area_of("PROPERTIES")
    area.ui_type = "ASSETS"
    yield 1.0
    space = area.spaces.active
    space.show_region_toolbar = False  # the catalogs
    space.params.asset_library_reference = "LOCAL"
    yield 1.5
    space.activate_asset_by_id(bpy.data.actions["brows"])
    yield 1.0
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        asset = bpy.context.asset
        walk.check(
            "the Asset Browser has the expression", asset is not None and asset.name == "brows"
        )
        bpy.ops.mimetic.apply_expression("EXEC_DEFAULT")
    raised = face().data.shape_keys.key_blocks["frontalis_middle.L"].value
    walk.check(
        "an asset chosen there is put on the face", abs(raised - 0.7) < 0.02, f"{raised:.2f}"
    )
    yield from walk.picture("expression-assets")


def put_in_sequence(walk: Walk) -> Steps:
    scene = bpy.context.scene
    bpy.ops.mimetic.rest_face()
    for frame, name in ((10, "smile"), (16, "brows")):
        scene.frame_set(frame)
        walk.check(
            f"{name} becomes a strip",
            bpy.ops.mimetic.sequence_expression(action=name) == {"FINISHED"},
        )
    _, area = area_of("FILE_BROWSER")
    area.ui_type = "NLA_EDITOR"
    yield 1.0
    scene.frame_set(24)
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(area=area, region=region):
        bpy.ops.nla.view_all()
    walk.check("they play together", value() > 0.3, f"{value():.2f}")
    yield from walk.picture("expression-strips")


def look_at_the_curves(walk: Walk) -> Steps:
    """The panel Curves counts keys, and its button makes few of them."""
    keys = face().data.shape_keys
    for track in list(keys.animation_data.nla_tracks):
        keys.animation_data.nla_tracks.remove(track)
    for frame in range(1, 61):
        keys.key_blocks[SMILE].value = max(0.0, 1 - abs(frame - 30) / 15)
        keys.key_blocks[SMILE].keyframe_insert("value", frame=frame)
    scene_out = sys.modules[f"{PACKAGE}.scene_out"]
    curves = [row.curve for row in scene_out.face_curves.of(face())]
    for point in curves[0].keyframe_points:
        point.interpolation = "LINEAR"
    _, area = area_of("NLA_EDITOR")
    area.ui_type = "FCURVES"
    yield from walk.picture("curves-dense")
    walk.check("Few Keys can be pressed", bpy.ops.mimetic.reduce_keys.poll())
    invoke("VIEW_3D", bpy.ops.mimetic.reduce_keys)
    yield 0.5
    count = len(curves[0].keyframe_points)
    walk.check("few keys are left", 3 <= count <= 12, count)
    walk.check("they play the same", abs(curves[0].evaluate(30) - 1.0) < 0.03)
    yield from walk.picture("curves-few")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from prepare(walk)
    yield from blend_by_dragging(walk)
    yield from look_at_the_assets(walk)
    yield from put_in_sequence(walk)
    yield from look_at_the_curves(walk)


start(steps)
