# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's ordinary tools on what was baked, by the screen's own keys and mouse: keys reduced and
smoothed in the Graph Editor, takes pushed down and blended in the NLA, poses of the library."""

import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import redo_panels
from undoing import PACKAGE, module, on_screen, press
from walk import Steps, Walk, area_of, install, invoke, override, split_view, start

MUSCLE = "zygomaticus_major.L"
PATHS = {
    "keys": f'key_blocks["{MUSCLE}"].value',
    "controls": f'pose.bones["{MUSCLE}"]["activation"]',
}
SMILING, AT_REST = 12, 30  # frames
LOOKED_AT = (1, 6, 9, SMILING, 15, 18, AT_REST, 45)
ALLOWED = 0.05  # by which reduced keys may miss the curve
LATER = 24  # frames by which the second take is moved in the NLA
SAME = 1e-5  # of values that drivers and strips went through, in single precision


def is_idle() -> bool:
    return module("jobs").running is None


def face() -> bpy.types.Object:
    return bpy.context.scene.mimetic.face


def holder(on: str) -> bpy.types.ID:
    """What has the curves: shape keys or the control object."""
    return face().data.shape_keys if on == "keys" else face().mimetic.control_object


def curve(on: str) -> bpy.types.FCurve:
    return module("compat").curves(holder(on)).fcurves.find(PATHS[on])


def keys_of(on: str) -> np.ndarray:
    """N x 2: frames and values."""
    return np.array([point.co[:] for point in curve(on).keyframe_points])


def curve_at(on: str, frames) -> np.ndarray:
    """Within the limits of a shape key, which cut off what a handle makes of it."""
    return np.clip([curve(on).evaluate(frame) for frame in frames], 0, 1)


def shown(frames) -> np.ndarray:
    """The muscle's shape key as the face is evaluated with it."""
    values, now = [], bpy.context.scene.frame_current
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        values.append(shown_now())
    bpy.context.scene.frame_set(now)
    return np.array(values)


def shown_now() -> float:
    graph = bpy.context.evaluated_depsgraph_get()
    return face().evaluated_get(graph).data.shape_keys.key_blocks[MUSCLE].value


def check_shown(walk: Walk, claim: str, frames, expected, tolerance: float = SAME) -> None:
    off = float(np.abs(shown(frames) - expected).max())
    walk.check(claim, off < tolerance, off)


def by_menu_search(walk: Walk, name: str, kind: str, words: str, first: str = "") -> Steps:
    """With the mouse over an editor; first: keys that are pressed before."""
    letters = " ".join("space" if letter == " " else letter for letter in words)
    typed = f"{first} F3 sleep 0.3 key --delay 20 {letters} sleep 0.3 key Return"
    yield from press(walk, name, kind, typed)


def undo(walk: Walk, name: str, kind: str, is_back: Callable[[], bool], before) -> Steps:
    """By one step; before: what the face showed."""
    yield from press(walk, f"{name}-undo", kind, "ctrl+z")
    yield from walk.until(is_back, 10, f"one undo takes {name} back")
    check_shown(walk, "and the face is as before", LOOKED_AT, before)


def lay_out() -> Steps:
    """The Graph Editor beside the 3D view."""
    yield from split_view("GRAPH_EDITOR", 0.45)
    for kind in ("VIEW_3D", "GRAPH_EDITOR"):
        area_of(kind)[1].spaces.active.show_region_ui = False


def bake(walk: Walk, name: str, to: str) -> Steps:
    bpy.context.scene.mimetic.performance_path = str(walk.folder / f"{name}.npz")
    options = {"to": to, "use_contact": False, "use_texture": False, "use_view": False}
    options["subdivision"] = 0  # drawn quickly
    invoke("VIEW_3D", bpy.ops.mimetic.bake, **options)
    yield from walk.until(is_idle, 60, f"the bake of {name} ends")
    yield 0.3


def take_hold(walk: Walk, on: str) -> Steps:
    """Of what the curves are of: the face, or all bones of its control object in pose mode."""
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()
    chosen = face() if on == "keys" else face().mimetic.control_object
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == chosen)
    bpy.context.view_layer.objects.active = chosen
    yield 0.3
    if on == "controls":
        yield from change_mode(walk, "POSE")
        yield from press(walk, "ordinary-all-bones", "VIEW_3D", "a")


def change_mode(walk: Walk, mode: str) -> Steps:
    """To pose mode and back."""
    yield from press(walk, f"ordinary-{mode}", "VIEW_3D", "ctrl+Tab")
    yield from walk.until(lambda: bpy.context.mode == mode, 10, f"keys go to mode {mode}")


def reduce_keys(walk: Walk, on: str) -> Steps:
    """As the menu Key > Density does, with the allowed change in its redo panel."""
    name, before, at_first = f"ordinary-{on}-reduced", keys_of(on), shown(LOOKED_AT)
    whole = "Home sleep 0.2 key a sleep 0.2 key"  # all in view, and selected
    yield from by_menu_search(walk, name, "GRAPH_EDITOR", "allowed", whole)

    def is_called() -> bool:
        return redo_panels.last().bl_idname == "GRAPH_OT_decimate"

    yield from walk.until(is_called, 10, f"{name} was called")
    if redo_panels.last().properties.remove_error_margin == 0:  # else Blender remembers it
        setting = "remove_error_margin", str(ALLOWED)
        yield from redo_panels.change(walk, name, "GRAPH_EDITOR", *setting, row=1)
    num_left = len(keys_of(on))
    walk.check(f"keys on {on} are reduced", 2 < num_left < 0.5 * len(before), num_left)
    check_shown(walk, "the face moves nearly as before", LOOKED_AT, at_first, 1.2 * ALLOWED)
    check_shown(walk, "as the curves say that are left", LOOKED_AT, curve_at(on, LOOKED_AT))
    if on == "keys":
        yield from walk.picture(name)
    is_back = lambda: np.array_equal(keys_of(on), before)  # noqa: E731
    yield from undo(walk, name, "GRAPH_EDITOR", is_back, at_first)


def smooth(walk: Walk, on: str) -> Steps:
    """By Alt + O."""
    name, before, at_first = f"ordinary-{on}-smoothed", keys_of(on), shown(LOOKED_AT)
    yield from press(walk, name, "GRAPH_EDITOR", "a sleep 0.2 key alt+o")

    def is_smooth() -> bool:
        return roughness(keys_of(on)) < 0.6 * roughness(before)

    yield from walk.until(is_smooth, 10, f"curves on {on} are smoothed")
    height = keys_of(on)[:, 1].max()
    walk.check("and the smile is left", height > 0.8 * before[:, 1].max(), height)
    check_shown(walk, "the face follows them", LOOKED_AT, curve_at(on, LOOKED_AT))
    if on == "controls":
        yield from walk.picture(name)
    is_back = lambda: np.array_equal(keys_of(on), before)  # noqa: E731
    yield from undo(walk, name, "GRAPH_EDITOR", is_back, at_first)


def roughness(keys: np.ndarray) -> float:
    return float(np.abs(np.diff(keys[:, 1], n=2)).mean())


def strips(on: str) -> list[bpy.types.NlaStrip]:
    """From below."""
    return [strip for track in holder(on).animation_data.nla_tracks for strip in track.strips]


def push_down(walk: Walk, on: str) -> Steps:
    """As the menu Action > Push Down Action does, in the Action Editor or that of shape keys."""
    area_of("DOPESHEET_EDITOR")[1].spaces.active.mode = "SHAPEKEY" if on == "keys" else "ACTION"
    yield 0.3
    at_first, count = shown(LOOKED_AT), len(strips(on))
    yield from by_menu_search(walk, f"ordinary-{on}-{count}-down", "DOPESHEET_EDITOR", "push down")
    yield from walk.until(lambda: len(strips(on)) == count + 1, 10, f"{on} are pushed down")
    walk.check("no action is left", holder(on).animation_data.action is None)
    check_shown(walk, "and the face moves as before", LOOKED_AT, at_first)


def push_the_keys(walk: Walk) -> Steps:
    at_first = shown(LOOKED_AT)
    yield from push_down(walk, "keys")

    def is_back() -> bool:
        return not strips("keys") and holder("keys").animation_data.action is not None

    yield from undo(walk, "ordinary-keys-down", "DOPESHEET_EDITOR", is_back, at_first)


def blend_takes(walk: Walk) -> Steps:
    """Both pushed down, and the second one moved to where the first one ends, to be blended in."""
    frames = range(1, walk.settings["frames"] + 1)
    hero = curve_at("controls", frames)
    yield from push_down(walk, "controls")
    yield from change_mode(walk, "OBJECT")  # a bake waits for it
    yield from bake(walk, "again", "CONTROLS")
    again = curve_at("controls", frames)
    walk.check("the second take is another", np.abs(again - hero).max() > 0.3)
    yield from take_hold(walk, "controls")
    yield from push_down(walk, "controls")
    yield from move_and_blend(walk, hero, again)
    first = face().mimetic.takes[1]  # of the control object
    invoke("VIEW_3D", bpy.ops.mimetic.play_take, take=first.name)
    check_shown(walk, "a take plays whatever strips there are", frames, hero)


def move_and_blend(walk: Walk, hero: np.ndarray, again: np.ndarray) -> Steps:
    """hero, again: values of the two takes, of all frames."""
    area = area_of("GRAPH_EDITOR")[1]
    area.type = "NLA_EDITOR"
    area.spaces.active.show_region_ui = False
    yield 0.3
    at_first, (lower, upper) = shown(LOOKED_AT), strips("controls")
    lower.select, upper.select = False, True
    letters = " ".join(str(LATER))
    name, editor = "ordinary-strip-moved", "NLA_EDITOR"
    yield from press(walk, name, editor, f"Home sleep 0.2 key g sleep 0.2 key {letters} Return")
    moved_to = lambda: strips("controls")[1].frame_start - 1  # noqa: E731
    yield from walk.until(lambda: moved_to() == LATER, 10, "the second strip is moved")
    halfway = shown(LOOKED_AT)
    with bpy.context.temp_override(**override(editor)):  # Auto Blend In/Out of its sidebar
        bpy.ops.wm.context_toggle("EXEC_DEFAULT", True, data_path="active_nla_strip.use_auto_blend")
    yield 0.3
    count = len(hero)
    share = np.clip((np.arange(count) - LATER) / (count - 1 - LATER), 0, 1)
    later = np.r_[np.full(LATER, again[0]), again[: count - LATER]]
    expected = (1 - share) * hero + share * later
    claim = "the face goes from one take to the other"
    check_shown(walk, claim, range(1, count + 1), expected)
    yield from walk.picture("ordinary-strips-blended")
    is_plain = lambda: not strips("controls")[1].use_auto_blend  # noqa: E731
    yield from undo(walk, "ordinary-strips-blended", editor, is_plain, halfway)
    yield from undo(walk, name, editor, lambda: moved_to() == 0, at_first)


def keep_a_pose(walk: Walk) -> Steps:
    """As an asset in this file, of all bones in the frame of the smile."""
    bpy.context.scene.frame_set(SMILING)
    yield 0.3
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.poselib.create_pose_asset(
            "EXEC_DEFAULT", True, pose_name="Smile", asset_library_reference="LOCAL"
        )
    pose = bpy.data.actions.get("Smile")
    walk.check("a pose asset is made", pose is not None and pose.asset_data is not None)
    kept = {curve.data_path for curve in module("compat").curves_in(pose)}
    walk.check("which holds the muscle", PATHS["controls"] in kept, len(kept))
    area = area_of("VIEW_3D")[1]
    area.spaces.active.show_region_asset_shelf = True

    def is_laid_out() -> bool:
        return shelf().height > 1

    yield from walk.until(is_laid_out, 10, "the asset shelf is shown")
    yield 0.5


def shelf() -> bpy.types.Region:
    regions = area_of("VIEW_3D")[1].regions
    return next(region for region in regions if region.type == "ASSET_SHELF")


def use_the_pose(walk: Walk) -> Steps:
    """By a click on it, and by a drag, while Blender keys what is posed."""
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    before, at_first, (smile,) = keys_of("controls"), shown(LOOKED_AT), shown([SMILING])
    x, y = on_screen(shelf().x + 40, shelf().y + shelf().height // 2)
    moves = "sleep 0.1 mousemove_relative 12 0 " * 6
    drag = f"sleep 0.2 mousedown 1 {moves} sleep 0.3 mouseup 1"
    is_back = lambda: np.array_equal(keys_of("controls"), before)  # noqa: E731
    for how, act in (("applied", "sleep 0.2 click 1"), ("blended", drag)):
        bpy.context.scene.frame_set(AT_REST)  # which an undo does not bring back
        name = f"ordinary-pose-{how}"
        yield from walk.ask(f"{name}.act", f"mousemove {x} {y} {act}")
        yield from walk.until(lambda: not is_back(), 10, f"a pose is {how} and keyed")
        share = shown([AT_REST])[0] / smile
        holds = abs(share - 1) < SAME if how == "applied" else 0.1 < share < 0.95
        walk.check("the face shows as much of it as the mouse says", holds, share)
        yield from walk.picture(name)
        yield from undo(walk, name, "VIEW_3D", is_back, at_first)


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.context.scene.render.fps = 25
    yield from lay_out()
    for on in ("keys", "controls"):
        yield from bake(walk, "hero", on.upper())
        yield from take_hold(walk, on)
        yield from reduce_keys(walk, on)
        yield from smooth(walk, on)
        if on == "keys":
            yield from push_the_keys(walk)
    yield from blend_takes(walk)
    yield from keep_a_pose(walk)
    yield from use_the_pose(walk)


start(steps)
