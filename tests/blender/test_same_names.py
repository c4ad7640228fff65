# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that share a name, linked or of another scene, are not taken for each other."""

import dataclasses

import bpy
import pytest
from conftest import make_performance
from last_result import result
from test_takes import rows

pytestmark = pytest.mark.oldest_and_newest

HEAD, CAMERA = "Face", "Footage Camera"


@pytest.fixture(scope="module")
def other():
    """Another performance, through another lens."""
    taken = make_performance(30, seed=3)
    intrinsics = taken.intrinsics.copy()
    intrinsics[0, 0] = intrinsics[1, 1] = 900
    return dataclasses.replace(taken, intrinsics=intrinsics)


@pytest.fixture
def asset(performance, extension, tmp_path):
    """A file with a baked face and its camera; then a new one is open."""
    path = tmp_path / "asset.blend"
    extension("scene_out").bake(bpy.context.scene, performance, "asset")
    for name in ("Face again", "Face Light"):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, None))
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return path


@pytest.fixture
def scene(asset):
    return bpy.context.scene


def link(path, *names) -> list[bpy.types.Object]:
    """Into the scene that is open."""
    with bpy.data.libraries.load(str(path), link=True) as (_, here):
        here.objects = list(names)
    for obj in here.objects:
        assert obj.library and obj.name in names
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = None
    return here.objects


def delete(obj) -> None:
    with bpy.context.temp_override(selected_objects=[obj], active_object=obj):
        assert bpy.ops.object.delete() == {"FINISHED"}


def test_only_what_is_there_is_held(extension, scene, asset):
    holds = extension("scene_in").holds
    own = bpy.data.objects.new(HEAD, None)
    owners = scene, bpy.context.view_layer, scene.collection
    assert not any(holds(owner, obj) for owner in owners for obj in (None, own))
    scene.collection.objects.link(own)
    (linked,) = link(asset, HEAD)
    assert all(holds(owner, obj) for owner in owners for obj in (own, linked))
    scene.collection.objects.unlink(own)
    bpy.context.view_layer.update()
    assert all(holds(owner, linked) and not holds(owner, own) for owner in owners)


def test_a_bake_leaves_another_scenes_face_and_camera(scene, asset, bake, performance, other):
    face, camera = bake(performance), scene.mimetic.camera
    lens, action = camera.data.lens, face.data.shape_keys.animation_data.action
    bpy.ops.scene.new(type="EMPTY")  # with the settings of before
    second = bpy.context.scene
    assert second.mimetic.face == face
    link(asset, HEAD, CAMERA)
    other.save(path := str(asset.with_name("second.performance.npz")))
    second.mimetic.performance_path = path
    assert bpy.ops.mimetic.bake(use_texture=False, use_contact=False) == {"FINISHED"}
    assert (camera.data.lens, face.data.shape_keys.animation_data.action) == (lens, action)
    assert rows(face) == ["hero"]
    for obj in (second.mimetic.face, second.mimetic.camera):
        assert obj in second.objects.values() and not obj.library
    assert second.camera == second.mimetic.camera
    assert bpy.context.active_object == second.mimetic.face


@pytest.mark.parametrize("what", ["face", "camera"])
def test_a_bake_makes_again_what_was_deleted(scene, asset, bake, performance, other, what):
    bake(performance)
    lost = getattr(scene.mimetic, what)
    delete(lost)
    link(asset, {"face": HEAD, "camera": CAMERA}[what])
    bake(other)
    made = getattr(scene.mimetic, what)
    assert made != lost and made in scene.objects.values() and not made.library


def test_buttons_mean_no_face_that_was_deleted(extension, scene, asset, bake, performance):
    scene_in, targets = extension("scene_in"), extension("targets")
    face = bake(performance)
    scene.mimetic.head.target = face
    assert scene_in.face_of(bpy.context) == face and not targets.no_head_target(bpy.context)
    delete(face)
    link(asset, HEAD)
    assert scene_in.face_of(bpy.context) is None
    assert "Choose the object" in targets.no_head_target(bpy.context)


def test_what_is_linked_hinders_no_update_of_a_deleted_face(extension, scene, asset):
    targets = extension("targets")
    scene.mimetic.face, scene.mimetic.camera = linked = link(asset, HEAD, CAMERA)
    assert "linked" in targets.no_update(scene)
    for obj in linked:
        scene.collection.objects.unlink(obj)
        scene.collection.objects.link(bpy.data.objects.new(obj.name, None))
    assert targets.no_update(scene) == ""


def test_a_job_finds_no_object_of_another_scene(extension, scene, asset):
    own_object = extension("writable").own_object
    first = bpy.data.objects.new(HEAD, None)
    scene.collection.objects.link(first)
    bpy.ops.scene.new(type="EMPTY")
    (linked,) = link(asset, HEAD)
    assert own_object(bpy.context.scene, HEAD) == linked
    assert own_object(scene, HEAD) == first


def test_a_copy_stands_beside_what_is_linked_and_named_as_it(
    extension, scene, asset, bake, performance
):
    face = bake(performance, "again")
    delete(scene.mimetic.camera)
    link(asset, "Face again", CAMERA)
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.compare_take() == {"FINISHED"}
    assert bpy.data.objects["Face again", None] in scene.objects.values()
    assert extension("scene_out").take_comparison._camera(scene) is None


def test_lights_named_as_what_is_linked_are_no_error(extension, scene, asset, bake, performance):
    face = bake(performance, use_render=False)
    link(asset, "Face Light")
    hidden = bpy.data.collections.new("Hidden")
    scene.collection.children.link(hidden)
    hidden.objects.link(face)
    scene.collection.objects.unlink(face)
    bpy.context.view_layer.layer_collection.children["Hidden"].exclude = True
    extension("scene_out.face_lights").ensure(scene, face)
    lamp = bpy.data.objects["Face Light", None]
    assert lamp.parent == face and lamp not in bpy.context.view_layer.objects.values()


def test_buttons_of_a_scene_that_a_script_gives_leave_the_windows(
    extension, scene, bake, performance, other, tmp_path
):
    face = bake(performance)
    bpy.ops.scene.new(type="NEW")
    second = bpy.context.scene
    path = tmp_path / "other.performance.npz"
    other.save(path)
    second.mimetic.performance_path = str(path)
    assert bpy.ops.mimetic.bake(use_texture=False, use_contact=False) == {"FINISHED"}
    bpy.context.window.scene = scene
    bpy.context.view_layer.objects.active = face
    assert bpy.context.active_object == face
    scene_in, targets, heads = (extension(name) for name in ("scene_in", "targets", "heads"))
    with bpy.context.temp_override(scene=second, view_layer=second.view_layers[0]):
        assert scene_in.face_of(bpy.context) == second.mimetic.face
        assert scene_in.shown_face(bpy.context) == second.mimetic.face
        assert targets.take_owner(bpy.context) == second.mimetic.face
        assert targets.bound_head(bpy.context) is None
        assert heads.active_head(bpy.context) == second.mimetic.face
        assert bpy.ops.mimetic.bake(use_texture=False, use_contact=False) == {"FINISHED"}
        assert bpy.ops.mimetic.exaggerate_curves(factor=2.0) == {"FINISHED"}
        assert result()["object"] == second.mimetic.face.name
    assert rows(face) == ["hero"] and len(rows(second.mimetic.face)) == 2
