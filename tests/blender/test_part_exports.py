# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyeballs, teeth and tongue that are objects of their own move in files as in the scene."""

import bpy
import numpy as np
import pytest
from test_exports import FPS, FRAMES, NEAR, ROWS, cut, read, world_vertices
from test_gltf import MOTION_METRES, furthest_from_nearest
from test_head_parts import NAMES, rows, split  # noqa: F401

MOVED = ("eye.L", "eye.R", "teeth_lower", "tongue")


@pytest.fixture
def played(extension, scene, split, acted):  # noqa: F811
    """The head and its parts in a take, in which jaw_side goes below 0 and the eyes turn."""
    scene.render.fps = FPS
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    short = cut(acted[0], ROWS)
    assert short.articulator_values[:, 1].min() < -0.1
    extension("scene_out.bound").bake(scene, short, "take", split)
    keys = split.data.shape_keys
    for frame, value in ((1, 0.0), (8, 1.0)):
        for name in ("look_in.L", "look_in.R"):
            keys.key_blocks[name].value = value
            keys.key_blocks[name].keyframe_insert("value", frame=frame)
    return split


def state_of(obj) -> list:
    keys = obj.data.shape_keys
    animation = keys.animation_data
    return [
        [(key.name, key.slider_min, key.slider_max, key.mute) for key in keys.key_blocks],
        [(curve.data_path, curve.mute) for curve in animation.drivers],
        animation.action,
    ]


def parted(objects) -> dict[str, bpy.types.Object]:
    """Meshes of a file by what they are called in the scene; Blender 5.2 reads a USD file's as
    empties of that name that carry the meshes."""
    names = {name.replace(".", "_"): name for name in ("Bust", *MOVED)}
    meshes = [obj for obj in objects if obj.type == "MESH"]
    called = [(said.replace(".", "_"), obj) for obj in meshes for said in (obj.data.name, obj.name)]
    return {names[plain]: obj for plain, obj in called if plain in names}


@pytest.mark.parametrize("suffix", (".glb", ".fbx", ".usdc", ".abc"))
@pytest.mark.oldest_and_newest
def test_parts_that_are_read_back_move_the_same(extension, scene, played, tmp_path, suffix):
    objects = {"Bust": played, **{name: bpy.data.objects[name] for name in MOVED}}
    expected = {
        name: [world_vertices(obj, frame) for frame in FRAMES] for name, obj in objects.items()
    }
    before = {name: state_of(objects[name]) for name in MOVED}
    num_actions = len(bpy.data.actions)
    path = tmp_path / f"head{suffix}"
    extension("scene_out.exports").write(scene, path, played)
    assert {name: state_of(objects[name]) for name in MOVED} == before
    assert len(bpy.data.actions) == num_actions
    for name, shown in expected.items():
        for frame, points in zip(FRAMES, shown, strict=True):
            np.testing.assert_array_equal(world_vertices(objects[name], frame), points)
    if suffix == ".glb":
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.scene.render.fps = FPS
        bpy.ops.import_scene.gltf(filepath=str(path))
        found = parted(bpy.context.scene.objects)
        late = round(found["Bust"].animation_data.action.frame_range[0]) - 1
    else:
        read_objects, late = read(path)
        found = parted(read_objects)
    assert sorted(found) == sorted(expected)
    for name, shown in expected.items():
        for frame, points in zip(FRAMES, shown, strict=True):
            actual = world_vertices(found[name], frame + late)
            if suffix == ".glb":
                apart = furthest_from_nearest(actual, points)
                assert apart < MOTION_METRES, (name, frame)
            else:
                assert np.abs(actual - points).max() < 10 * NEAR[suffix], (name, frame)


def test_parts_on_what_carries_the_head_are_exported(extension, scene, split):  # noqa: F811
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    carrier = bpy.data.objects.new("carrier", None)
    scene.collection.objects.link(carrier)
    for obj in (split, bpy.data.objects["eye.L"]):
        obj.parent = carrier
    bpy.context.view_layer.update()
    objects = extension("scene_out.selection").character_objects(scene, split)
    assert bpy.data.objects["eye.L"] in objects
