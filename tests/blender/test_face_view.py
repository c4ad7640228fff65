# SPDX-License-Identifier: GPL-3.0-or-later
"""In the camera's view: how much of the face covers the footage, the face as lines, and its key."""

import bpy
import pytest
from conftest import MODULE
from panel_texts import drawn

KEY = "mimetic.face_as_lines"


@pytest.fixture
def baked(scene, footage, sheet_file):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    scene.render.fps = 25
    bpy.ops.mimetic.bake(use_texture=False)
    return scene.mimetic


def images(scene):
    return scene.camera.data.background_images


def test_the_footage_is_laid_over_the_face_by_as_much(baked, scene):
    assert baked.face_cover == 1 and len(images(scene)) == 1
    baked.face_cover = 1
    assert len(images(scene)) == 1
    baked.face_cover = 0.25
    behind, front = images(scene)
    assert (behind.display_depth, behind.alpha) == ("BACK", 1)
    assert (front.display_depth, front.alpha, front.show_background_image) == ("FRONT", 0.75, True)
    assert front.clip == behind.clip == baked.clip
    assert front.frame_method == behind.frame_method
    assert baked.face_cover == pytest.approx(0.25)
    baked.face_cover = 1
    assert not front.show_background_image
    assert baked.face_cover == 1


def test_it_goes_along_with_the_next_bake_and_another_rate(baked, scene):
    baked.face_cover = 0.4
    scene.render.fps = 50
    bpy.ops.mimetic.bake(use_texture=False)
    behind, front = images(scene)
    assert behind.source == front.source == "IMAGE" and behind.image == front.image
    assert baked.face_cover == pytest.approx(0.4)
    seen = set()
    for frame in (3, 20, 41):
        scene.frame_set(frame)
        camera = scene.camera.data.evaluated_get(bpy.context.evaluated_depsgraph_get())
        offsets = [image.image_user.frame_offset for image in camera.background_images]
        assert offsets[0] == offsets[1]
        seen.add(offsets[0])
    assert len(seen) == 3
    scene.render.fps = 25
    bpy.ops.mimetic.bake(use_texture=False)
    behind, front = images(scene)
    assert front.clip == behind.clip == baked.clip
    assert not [d for d in scene.camera.data.animation_data.drivers if "[1]" in d.data_path]


def test_an_image_of_the_users_before_the_face_stays(baked, scene):
    grid = images(scene).new()
    grid.display_depth, grid.alpha = "FRONT", 0.3
    assert baked.face_cover == 1
    baked.face_cover = 0.5
    assert grid.alpha == pytest.approx(0.3)
    assert len(images(scene)) == 3


def test_without_footage_there_is_nothing_to_lay_over(scene):
    scene.mimetic.face_cover = 0.5
    assert scene.mimetic.face_cover == 1


@pytest.mark.parametrize("before", ["TEXTURED", "BOUNDS"])
def test_lines_and_back(baked, scene, before):
    face = baked.face
    face.display_type = before
    assert bpy.ops.mimetic.face_as_lines() == {"FINISHED"}
    assert face.display_type == "WIRE"
    assert bpy.ops.mimetic.face_as_lines() == {"FINISHED"}
    assert face.display_type == before
    assert "mimetic_shown_as" not in face


def test_without_a_face_the_button_is_grey_and_its_key_another_ones():
    assert not bpy.ops.mimetic.face_as_lines.poll()


def test_undo_takes_slider_and_lines_back(baked, scene):
    bpy.ops.ed.undo_push(message="baked")
    baked.face_cover = 0.5
    bpy.ops.mimetic.face_as_lines()
    bpy.ops.ed.undo_push(message="shown")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        assert bpy.ops.ed.undo() == {"FINISHED"}
    settings = bpy.context.scene.mimetic
    assert settings.face_cover == 1
    assert settings.face.display_type == "TEXTURED"


def keys_of_ours() -> list:
    maps = bpy.context.window_manager.keyconfigs.addon.keymaps
    return [
        (keymap.name, item.type)
        for keymap in maps
        for item in keymap.keymap_items
        if item.idname.startswith("mimetic.")
    ]


def test_the_key_comes_and_goes_with_the_extension():
    assert keys_of_ours() == [("Object Mode", "Y"), ("Pose", "Y"), ("Window", "ESC")]
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert keys_of_ours() == []
    bpy.ops.preferences.addon_enable(module=MODULE)
    assert len(keys_of_ours()) == 3


def test_blender_has_no_such_key_of_its_own(extension):
    """In what it is pressed in, and in what lies around that."""
    maps = bpy.context.window_manager.keyconfigs.default.keymaps
    names = {name for name, *_ in extension("keys").KEYS}
    for name in (*names, "Object Non-modal", "3D View", "3D View Generic", "Frames", "Screen"):
        if name not in maps:
            continue
        taken = [i for i in maps[name].keymap_items if i.type == "Y" and i.value == "PRESS"]
        assert [i.idname for i in taken if not (i.shift or i.ctrl or i.alt)] == []


def test_the_panel_has_both(baked):
    text = drawn("MIMETIC_PT_overlays")
    assert "face_cover" in text and KEY in text
    assert KEY in drawn("MIMETIC_MT_object")


def shadings() -> list:
    screens = {window.screen for window in bpy.context.window_manager.windows}
    areas = [area for screen in screens for area in screen.areas if area.type == "VIEW_3D"]
    return [area.spaces.active.shading for area in areas]


@pytest.mark.parametrize("light", ["STUDIO", "MATCAP"])
def test_solid_mode_shows_the_face_as_filmed_unless_a_light_was_chosen(
    scene, footage, light, sheet_file
):
    assert shadings()
    for shading in shadings():
        shading.light = light
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.mimetic.bake(use_texture=False)
    assert {shading.color_type for shading in shadings()} == {"TEXTURE"}
    expected = "FLAT" if light == "STUDIO" else light
    assert {shading.light for shading in shadings()} == {expected}
