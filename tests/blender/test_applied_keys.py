# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked face whose shape keys were applied (Shape Keys > Apply All): buttons say what to do."""

import bpy
import pytest
from last_result import result

LOST = "Face has lost its shape keys: bake it again"


@pytest.fixture
def applied(bake, performance):
    """A face with two takes, contact among what they move, whose keys are gone."""
    face = bake(performance, use_contact=True)
    bake(performance, "again", use_contact=True)
    apply(face)
    return face


def apply(face) -> None:
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.object.shape_key_remove(all=True, apply_mix=True) == {"FINISHED"}
    assert face.data.shape_keys is None


def test_what_needs_sliders_is_grey_and_says_how_to_get_them(extension, applied):
    for button in ("rest_face", "keep_expression", "add_control_object", "exaggerate_curves"):
        with pytest.raises(RuntimeError, match=LOST):
            getattr(bpy.ops.mimetic, button)()
    assert extension("live").no_live(bpy.context) == LOST
    assert bpy.ops.mimetic.export_gltf.poll()  # which needs none


def test_a_character_of_the_users_that_lost_them_gets_its_own_way_out(scene):
    assert bpy.ops.mimetic.add_face() == {"FINISHED"}
    face = bpy.context.active_object
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    control = face.mimetic.control_object
    apply(face)
    bpy.context.view_layer.objects.active = control
    with pytest.raises(RuntimeError, match="Face has no sliders: press Attach Muscles"):
        bpy.ops.mimetic.keep_expression()
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}


def test_a_take_plays_what_is_left_and_says_what_is_not(applied):
    assert bpy.ops.mimetic.play_take(take="hero") == {"FINISHED"}
    message = result()["message"]
    assert "hero plays on Face" in message and "Face has no shape key" in message
    assert bpy.ops.mimetic.blend_takes(take="again", over="hero") == {"FINISHED"}
    assert bpy.ops.mimetic.compare_take(take="hero") == {"FINISHED"}


def test_a_face_with_a_control_object_is_compared(bake, performance):
    face = bake(performance)
    face.data.shape_keys.animation_data_clear()
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    bpy.context.view_layer.objects.active = None
    bake(performance, "again")
    apply(face)
    assert bpy.ops.mimetic.compare_take(take="again") == {"FINISHED"}
    assert "Face again" in bpy.data.objects
