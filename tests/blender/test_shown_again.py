# SPDX-License-Identifier: GPL-3.0-or-later
"""Editors are not of the document: what an undo takes from them a redo must bring back."""

import bpy
import pytest
from conftest import MODULE, enable
from scene_state import in_window


@pytest.fixture
def editor():
    area = bpy.context.window_manager.windows[0].screen.areas[0]
    before, area.type = area.type, "CLIP_EDITOR"
    yield area.spaces.active
    area.type = before


def view_area() -> bpy.types.Area:
    areas = bpy.context.window_manager.windows[0].screen.areas
    return next(area for area in areas if area.type == "VIEW_3D")


def bake(**options) -> None:
    plain = {"use_contact": False, "use_texture": False}
    assert bpy.ops.mimetic.bake("EXEC_DEFAULT", True, **plain, **options) == {"FINISHED"}


@pytest.fixture
def view(sheet_file, request):
    """Of Blender's start-up scene; if not False, with a face in local view, as the cube would hide
    the footage."""
    bpy.ops.preferences.addon_disable(module=MODULE)
    bpy.ops.wm.read_factory_settings()
    enable()
    bpy.context.scene.mimetic.performance_path = str(sheet_file)
    bpy.ops.ed.undo_push(message="before")
    if getattr(request, "param", True):
        bake()
    return view_area().spaces.active


def isolated(view) -> list[str]:
    layer = bpy.context.view_layer
    layer.update()
    if view.local_view is None:
        return []
    evaluated = [obj.evaluated_get(layer.depsgraph) for obj in layer.objects]
    return sorted(obj.name for obj in evaluated if obj.local_view_get(view))


def test_a_redo_shows_the_clip_again_that_an_undo_took(scene, footage, editor):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mimetic.load_clip("EXEC_DEFAULT", True, filepath=str(footage))
    assert editor.clip is not None
    in_window(bpy.ops.ed.undo)
    assert editor.clip is None
    in_window(bpy.ops.ed.redo)
    assert editor.clip is not None
    assert editor.clip == bpy.context.scene.mimetic.clip


def test_an_editor_that_somebody_emptied_stays_empty(scene, footage, editor):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.mimetic.load_clip("EXEC_DEFAULT", True, filepath=str(footage))
    in_window(bpy.ops.ed.undo)
    in_window(bpy.ops.ed.redo)
    editor.clip = None
    bpy.ops.ed.undo_push(message="emptied")
    in_window(bpy.ops.ed.undo)
    assert bpy.context.scene.mimetic.clip is not None
    assert editor.clip is None


def test_a_redo_shows_the_face_alone_again_that_an_undo_took(view):
    alone, selected = isolated(view), [obj.name for obj in bpy.context.selected_objects]
    assert alone == ["Face", "Footage Camera"]
    for _ in range(2):
        in_window(bpy.ops.ed.undo)
        in_window(bpy.ops.ed.redo)
        assert isolated(view) == alone
        assert view.region_3d.view_perspective == "CAMERA"
        assert [obj.name for obj in bpy.context.selected_objects] == selected


def test_a_local_view_that_somebody_left_stays_left(view):
    area, window = view_area(), bpy.context.window_manager.windows[0]
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview(frame_selected=False)
    assert view.local_view is None
    bpy.ops.ed.undo_push(message="left")
    bpy.ops.ed.undo_push(message="later")
    in_window(bpy.ops.ed.undo)
    in_window(bpy.ops.ed.redo)
    assert view.local_view is None


def look(view) -> tuple:
    """All of it that a bake changes."""
    of, place = view.shading, view.region_3d
    chosen = of.light, of.color_type, of.show_cavity, of.cavity_type
    chosen += of.cavity_ridge_factor, of.curvature_ridge_factor
    at = *place.view_rotation, *place.view_location, place.view_distance
    at = [round(one, 4) for one in at] if place.view_perspective != "CAMERA" else []
    return (place.view_perspective, view.local_view is not None, *chosen), at


@pytest.mark.parametrize("view", [False], indirect=True)
def test_a_view_turns_back_when_the_bake_is_undone(view):
    """From above, with the start-up cube before the face; and again with the redo."""
    view.region_3d.view_rotation = (1, 0, 0, 0)
    before = look(view)
    bake()
    at_last = look(view)
    assert at_last[0][:2] == ("CAMERA", True)
    for _ in range(2):
        in_window(bpy.ops.ed.undo)
        assert look(view) == before
        in_window(bpy.ops.ed.redo)
        assert look(view) == at_last


@pytest.mark.parametrize("view", [False], indirect=True)
def test_each_of_two_bakes_turns_back_by_itself(view):
    at_first = look(view)
    bake()
    view.region_3d.view_perspective = "PERSP"
    view.shading.light = "MATCAP"
    between = look(view)
    bake()
    assert view.region_3d.view_perspective == "CAMERA"
    in_window(bpy.ops.ed.undo)
    assert look(view) == between
    in_window(bpy.ops.ed.undo)
    assert view.region_3d.view_perspective == at_first[0][0]
    assert view.shading.light == "MATCAP"  # chosen by hand since


@pytest.mark.parametrize("view", [False], indirect=True)
def test_a_view_that_was_not_turned_stays(view):
    before = look(view)
    bake(use_view=False)
    in_window(bpy.ops.ed.undo)
    assert look(view) == before
    in_window(bpy.ops.ed.redo)
    assert look(view) == before
