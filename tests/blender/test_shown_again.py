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


@pytest.fixture
def view(performance_file):
    """Of Blender's start-up scene, with a face in local view: the cube would hide the footage."""
    bpy.ops.preferences.addon_disable(module=MODULE)
    bpy.ops.wm.read_factory_settings()
    enable()
    bpy.context.scene.mimetic.performance_path = str(performance_file)
    bpy.ops.ed.undo_push(message="before")
    answer = bpy.ops.mimetic.bake("EXEC_DEFAULT", True, use_contact=False, use_texture=False)
    assert answer == {"FINISHED"}
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
