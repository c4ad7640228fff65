# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake that cannot go on with the face of its footage makes another, and says so."""

import bpy
import pytest
from last_result import result

pytestmark = pytest.mark.oldest_and_newest

TOLD = "Face.001 is new, and Face stays as it is; hide or delete one"


def test_a_bake_says_that_the_face_has_other_vertices(bake, performance):
    face = bake(performance)
    bpy.ops.mesh.primitive_cube_add(size=0.02)
    cube = bpy.context.object
    with bpy.context.temp_override(active_object=face, selected_editable_objects=[face, cube]):
        assert bpy.ops.object.join() == {"FINISHED"}
    assert bake(performance, "again") != face
    assert f"Face has other vertices than were baked: {TOLD}" in result()["message"]
    bake(performance, "once more")
    assert "is new" not in result()["message"]


def test_a_bake_says_that_the_face_is_in_no_collection_of_the_scene(bake, performance):
    face = bake(performance)
    actor = bpy.data.collections.new("Actor")
    bpy.context.scene.collection.objects.unlink(face)
    actor.objects.link(face)
    bake(performance, "again")
    assert f"Face is in no collection of the scene: {TOLD}" in result()["message"]


def test_a_bake_says_nothing_of_a_face_that_was_deleted(bake, performance):
    bpy.context.scene.collection.objects.unlink(bake(performance))
    bake(performance, "again")
    assert "is new" not in result()["message"]
