# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 after a bake: the face over its footage, and a user's own nodes as they were."""

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view

SAMPLES = 4


@pytest.fixture
def loaded(scene, footage, sheet_file):
    """A new file as Blender starts with it, its cube and its view transform."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    bpy.context.object.name = "Cube"
    scene.view_settings.view_transform = "AgX"
    scene.render.resolution_x, scene.render.resolution_y = 400, 300
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    scene.render.fps = 25


def rendered(scene, tmp_path, frame: int) -> np.ndarray:
    """H x W x 4, first row on top, as the file has it."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = SAMPLES, False
    scene.frame_set(frame)
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(tmp_path / f"{frame}.png")
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(scene.render.filepath)
    picture.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(picture.pixels), dtype=np.float32)
    picture.pixels.foreach_get(pixels)
    return pixels.reshape(picture.size[1], picture.size[0], 4)[::-1]


def stripes(frame: int) -> np.ndarray:
    """The `footage` of conftest, in which each column has one colour."""
    column, i = np.arange(400), frame - 1
    colours = np.stack([column + 3 * i, 2 * column, 255 - column + i], axis=1) % 256
    return np.broadcast_to(colours / 255, (300, 400, 3))


def is_face_at(scene) -> tuple[int, int]:
    """Column and row of the head's middle."""
    face, (width, height) = scene.mimetic.face, (400, 300)
    u, v, _ = world_to_camera_view(scene, scene.camera, face.matrix_world.translation)
    return round(u * width), round((1 - v) * height)


@pytest.mark.parametrize("fps", [25, 50], ids=["as a clip", "as frames of an image"])
def test_a_render_shows_the_face_over_its_footage(loaded, scene, tmp_path, fps):
    scene.render.fps = fps
    assert bpy.ops.mimetic.bake(use_texture=False) == {"FINISHED"}
    frame = 21
    picture = rendered(scene, tmp_path, frame)
    assert picture[..., 3].min() > 0.99
    footage_frame = 21 if fps == 25 else 11
    beside = np.abs(picture[:, 5:20, :3] - stripes(footage_frame)[:, 5:20])
    assert np.median(beside) < 0.04  # the codec's own loss is some .02
    column, row = is_face_at(scene)
    before = picture[row - 8 : row + 8, column - 8 : column + 8, :3]
    there = stripes(footage_frame)[row - 8 : row + 8, column - 8 : column + 8]
    assert np.abs(before - there).mean() > 0.1
    assert before.mean() > 0.25, "the face is lit"


def test_footage_keeps_its_shape_in_a_wider_picture(loaded, scene, tmp_path):
    scene.render.resolution_x = 800
    bpy.ops.mimetic.bake(use_texture=False)
    picture = rendered(scene, tmp_path, 21)
    assert picture[:, 20:180].max() < 0.05  # nothing is there: the footage takes half of the width
    inside = np.abs(picture[:, 205:220, :3] - stripes(21)[:, 5:20])
    assert np.median(inside) < 0.04


@pytest.mark.parametrize("size", [(800, 300), (400, 300), (1000, 750)])
@pytest.mark.oldest_and_newest
def test_footage_keeps_its_shape_where_the_picture_gets_another_after_the_bake(
    loaded, scene, extension, tmp_path, size
):
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    bpy.ops.mimetic.bake(use_texture=False)
    scene.render.resolution_x, scene.render.resolution_y = size
    picture = rendered(scene, tmp_path, 21)
    scale = size[1] / 300
    left = (size[0] - 400 * scale) / 2
    columns = np.round(left + scale * (np.arange(5, 20) + 0.5)).astype(int)
    inside = np.abs(picture[:, columns, :3] - stripes(21)[:1, 5:20])
    assert np.median(inside) < 0.04
    drivers = extension("compat").compositor(scene).animation_data.drivers
    assert drivers and all(curve.driver.is_simple_expression for curve in drivers), (
        "they need no script, which a file may not run"
    )


REGIONS = [(0.25, 0.75, 0.25, 1.0), (0.303, 0.7, 0.107, 0.99), (0.3, 0.7, 0.6, 0.9)]


def set_region(scene, region) -> None:
    render = scene.render
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = region


def part_of(whole, region) -> np.ndarray:
    """The region's pixels, of floats as coarse as Blender's."""
    (height, width), sides = whole.shape[:2], np.float32(region)
    left, right = (int(side * np.float32(width)) for side in sides[:2])
    below, above = (int(side * np.float32(height)) for side in sides[2:])
    return whole[height - above : height - below, left:right]


@pytest.mark.parametrize("width", [400, 401, 800])
def test_a_cropped_region_shows_its_part_of_the_footage(loaded, scene, extension, tmp_path, width):
    if width % 2 and not extension("compat").PIXELS_ARE_ALIGNED:
        pytest.skip("its footage lies half a pixel beside, which is rounded either way")
    bpy.ops.mimetic.bake(use_texture=False)
    scene.mimetic.face.hide_render = True  # whose samples differ from render to render
    scene.render.resolution_x = width
    whole = rendered(scene, tmp_path, 21)
    scene.render.use_border = scene.render.use_crop_to_border = True
    for region in REGIONS:
        set_region(scene, region)
        picture, expected = rendered(scene, tmp_path, 21), part_of(whole, region)
        assert picture.shape == expected.shape
        differ = np.abs(picture - expected)
        if not extension("compat").RENDER_SIZE_IS_CROPPED:  # rounds, and may lose a line at an edge
            differ = differ[1:-1, 1:-1]
        assert differ.max() < 0.02, region
    scene.render.use_crop_to_border = False
    np.testing.assert_allclose(part_of(rendered(scene, tmp_path, 21), region), expected, atol=0.02)


def test_the_start_up_cube_stays_but_is_out_of_the_way(loaded, scene, extension):
    bpy.ops.mimetic.bake(use_texture=False)
    cube = scene.objects["Cube"]
    assert cube.hide_render and not cube.hide_viewport and not cube.hide_get()
    assert scene.view_settings.view_transform == "Standard"
    text = bpy.context.window_manager.mimetic_result
    assert "Cube, in which the camera stands, is left out of renders" in text
    assert "instead of AgX" in text


def test_a_box_of_the_users_is_rendered(loaded, scene):
    cube = scene.objects["Cube"]
    cube.data.vertices[0].co.x -= 0.5
    bpy.ops.mimetic.bake(use_texture=False)
    assert not cube.hide_render
    assert scene.view_settings.view_transform == "AgX"
    assert "Color Management" in bpy.context.window_manager.mimetic_result


def own_nodes(scene, extension) -> tuple:
    tree = extension("compat").compositor(scene)
    return tuple(sorted((n.name, n.bl_idname) for n in tree.nodes)), len(tree.links)


def test_nodes_of_the_users_stay(loaded, scene, extension):
    compat = extension("compat")
    tree, result = compat.new_compositor(scene, "Mine")
    layers = tree.nodes.new("CompositorNodeRLayers")
    tree.links.new(layers.outputs["Image"], result)
    before = own_nodes(scene, extension)
    bpy.ops.mimetic.bake(use_texture=False)
    assert own_nodes(scene, extension) == before
    assert not scene.render.film_transparent
    assert not scene.objects["Cube"].hide_render
    assert scene.view_settings.view_transform == "AgX"
    assert "nodes of your own" in bpy.context.window_manager.mimetic_result


def test_it_is_an_option(loaded, scene, extension):
    bpy.ops.mimetic.bake(use_texture=False, use_render=False)
    assert extension("compat").compositor(scene) is None
    assert not scene.render.film_transparent
    assert not [o for o in scene.objects if o.type == "LIGHT"]


def test_baking_again_keeps_what_was_changed_on_the_nodes(loaded, scene, extension):
    bpy.ops.mimetic.bake(use_texture=False)
    tree = extension("compat").compositor(scene)
    tree.nodes.new("CompositorNodeBlur")
    scene.view_settings.view_transform = "AgX"
    before = own_nodes(scene, extension)
    lights = [o for o in scene.objects if o.type == "LIGHT"]
    assert lights and all(o.parent == scene.mimetic.face for o in lights)
    assert all(o.hide_get() and not o.hide_render for o in lights), "in renders, not in the way"
    for light in lights:
        bpy.data.objects.remove(light)
    bpy.ops.mimetic.bake(use_texture=False)
    assert own_nodes(scene, extension) == before
    assert scene.view_settings.view_transform == "AgX"
    assert not [o for o in scene.objects if o.type == "LIGHT"]


def test_one_undo_takes_it_back(loaded, scene, extension):
    bpy.ops.ed.undo_push(message="loaded")
    bpy.ops.mimetic.bake(use_texture=False)
    bpy.ops.ed.undo_push(message="baked")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        assert bpy.ops.ed.undo() == {"FINISHED"}
    scene = bpy.context.scene
    tree = extension("compat").compositor(scene)
    assert tree is None or not tree.nodes
    assert not scene.render.film_transparent
    assert scene.view_settings.view_transform == "AgX"
