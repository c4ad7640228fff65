# SPDX-License-Identifier: GPL-3.0-or-later
"""What is added while a collection or a scene of another file is the active one: it takes no
objects."""

import bmesh
import bpy
import pytest


@pytest.fixture
def linked(tmp_path):
    """Links a scene or collection of a file whose scene, Theirs, has a collection, Set."""

    def link(kind: str, name: str) -> bpy.types.ID:
        library = str(tmp_path / "set.blend")
        bpy.context.scene.name = "Theirs"
        bpy.context.scene.collection.children.link(bpy.data.collections.new("Set"))
        bpy.ops.wm.save_as_mainfile(filepath=library)
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        with bpy.data.libraries.load(library, link=True) as (_, target):
            setattr(target, kind, [name])
        return getattr(target, kind)[0]

    return link


@pytest.fixture
def in_linked(linked):
    """The scene, whose active collection is linked."""
    collection = linked("collections", "Set")
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.collection.children.link(collection)
    layer.active_layer_collection = layer.layer_collection.children["Set"]
    assert bpy.context.collection.library
    return scene


def test_a_face_goes_into_the_scenes_own_collection(in_linked):
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    assert list(bpy.context.active_object.users_collection) == [in_linked.collection]


def test_landmarks_go_into_the_scenes_own_collection(in_linked):
    ball = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
    in_linked.collection.objects.link(ball)
    made = bmesh.new()
    bmesh.ops.create_uvsphere(made, u_segments=32, v_segments=16, radius=0.1)
    made.to_mesh(ball.data)
    made.free()
    bpy.context.view_layer.objects.active = ball
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.add_landmarks() == {"FINISHED"}
    assert len(ball.children) > 0
    assert {mark.users_collection for mark in ball.children} == {(in_linked.collection,)}


def test_a_collection_of_this_file_is_kept_to(scene):
    own = bpy.data.collections.new("Own")
    scene.collection.children.link(own)
    layer = bpy.context.view_layer
    layer.active_layer_collection = layer.layer_collection.children["Own"]
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    assert list(bpy.context.active_object.users_collection) == [own]


def test_in_a_linked_scene_the_buttons_are_grey_and_say_why(linked):
    scene = linked("scenes", "Theirs")
    bpy.context.window.scene = scene
    with pytest.raises(RuntimeError, match=r"Theirs is linked from set\.blend: make it local"):
        bpy.ops.mimetic.add_face()
    assert not bpy.ops.mimetic.add_landmarks.poll()
