# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an object stands that is switched off, and that properties of ours still name: with its
parent, although Blender does not move it along."""

import bpy
import numpy as np
import pytest
from test_bake import evaluated_vertices


def lay(obj) -> bpy.types.Collection:
    """Puts an object into a collection of its own."""
    own = bpy.data.collections.new("Own")
    bpy.context.scene.collection.children.link(own)
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    own.objects.link(obj)
    return own


def layer() -> bpy.types.LayerCollection:
    return bpy.context.view_layer.layer_collection.children["Own"]


SWITCHES = {
    "shown": lambda obj, off: None,
    "eye": lambda obj, off: obj.hide_set(off),
    "viewport": lambda obj, off: setattr(obj, "hide_viewport", off),
    "collection's eye": lambda obj, off: setattr(layer(), "hide_viewport", off),
    "collection": lambda obj, off: setattr(layer().collection, "hide_viewport", off),
    "excluded": lambda obj, off: setattr(layer(), "exclude", off),
}


@pytest.fixture(params=SWITCHES)
def switch(request):
    return SWITCHES[request.param]


@pytest.fixture
def root(scene):
    empty = bpy.data.objects.new("Set", None)
    scene.collection.objects.link(empty)
    return empty


def move(root) -> None:
    root.location, root.rotation_euler = (3, 1, 0), (0, 0, 1)
    bpy.context.view_layer.update()


def in_camera(scene, face) -> np.ndarray:
    matrix = np.array(scene.camera.matrix_world.inverted())
    points = evaluated_vertices(face, 20)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("is_reopened", [False, True])
def test_a_face_that_is_off_is_baked_before_its_camera(
    scene, bake, performance, root, switch, is_reopened, tmp_path
):
    face = bake(performance)
    expected = in_camera(scene, face)
    face.parent = scene.camera.parent = root
    lay(face)
    bpy.context.view_layer.update()
    switch(face, True)
    bpy.context.view_layer.update()
    move(root)
    if is_reopened:
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
        bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
        scene = bpy.context.scene
    assert bpy.ops.mimetic.bake(use_texture=False, use_contact=False) == {"FINISHED"}
    face = scene.mimetic.face
    switch(face, False)
    bpy.context.view_layer.update()
    np.testing.assert_allclose(in_camera(scene, face), expected, atol=2e-5)


def test_a_target_of_the_head_that_is_off_stands_with_its_parent(extension, scene, root, switch):
    target = bpy.data.objects.new("Target", None)
    scene.collection.objects.link(target)
    target.parent, target.location = root, (0.1, 0, 0)
    scene.mimetic.head.target = target
    lay(target)
    bpy.context.view_layer.update()
    switch(target, True)
    bpy.context.view_layer.update()
    move(root)
    expected = root.matrix_world @ target.matrix_parent_inverse @ target.matrix_basis
    np.testing.assert_allclose(extension("world").matrix(target), expected, atol=1e-6)


@pytest.mark.parametrize("how", ["constraint", "delta", "bone"])
def test_what_more_than_a_parent_places_stands_where_blender_has_it(extension, scene, how):
    """It is off, and still moved along as one that is shown hangs on it."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    followed, child = (bpy.data.objects.new(name, None) for name in ("Off", "Shown"))
    for obj in (rig, followed, child):
        scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("head").tail = (0, 0, 0.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    child.parent, rig.location = followed, (2, 0, 0)
    if how == "constraint":
        followed.constraints.new("COPY_LOCATION").target = rig
    elif how == "delta":
        followed.delta_location = (0, 3, 0)
    else:
        followed.parent, followed.parent_type, followed.parent_bone = rig, "BONE", "head"
    followed.hide_viewport = True
    bpy.context.view_layer.update()
    np.testing.assert_allclose(extension("world").matrix(followed), child.matrix_world, atol=1e-6)
    assert child.matrix_world.translation.length > 1
