# SPDX-License-Identifier: GPL-3.0-or-later
"""Control objects that were deleted, that strips play, and of faces that are switched off."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_bake import METRES
from test_bake_bound import world_at
from test_control_object import CLOSE, control_of, shown

pytestmark = pytest.mark.oldest_and_newest

SWITCHES = ("object disabled", "collection disabled", "collection excluded")


def select(obj) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def delete(control, face) -> None:
    """By X, which leaves it in the file, out of the scene."""
    select(control)
    assert bpy.ops.object.delete() == {"FINISHED"}
    select(face)


def assert_shown(face, expected, near=CLOSE) -> None:
    for one, other in zip(shown(face), expected, strict=True):
        assert np.abs(one - other).max() < near


def test_a_face_whose_control_object_was_deleted_bakes_before_its_footage(
    scene, bake, sheet, tmp_path
):
    expected = shown(bake(sheet))
    bpy.data.objects.remove(scene.mimetic.face)
    face = bake(sheet, to="CONTROLS")
    scene.frame_set(12)
    delete(control_of(face), face)
    bake(sheet)
    assert face.parent is None and face.parent_type == "OBJECT"
    assert_shown(face, expected, METRES)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert_shown(bpy.context.scene.mimetic.face, expected, METRES)


def test_a_new_one_in_place_of_a_deleted_one_moves_the_face(scene, bake, sheet):
    face = bake(sheet, to="CONTROLS")
    scene.frame_set(12)
    delete(control_of(face), face)
    expected = world_at(face, 12)
    assert bpy.ops.mimetic.add_control_object() == {"FINISHED"}
    assert face.parent == control_of(face) and control_of(face).users_scene
    for frame in (12, 30):
        np.testing.assert_allclose(world_at(face, frame), expected, atol=1e-6)


def test_the_motion_of_strips_is_kept(bake, sheet):
    face = bake(sheet, to="CONTROLS", use_strips=True)
    (strip,) = control_of(face).animation_data.nla_tracks[0].strips
    action, expected = strip.action, shown(face)
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}
    assert result()["num_curves"] > 40
    assert_shown(face, expected)
    assert action.use_fake_user
    assert face.animation_data.action.name == "hero head"


def switch(face, how: str, is_on: bool) -> None:
    """A face and its control object, by themselves or with the one collection that there is."""
    if how == "object disabled":
        for obj in {face, control_of(face)} - {None}:
            obj.hide_viewport = not is_on
    (layer,) = bpy.context.view_layer.layer_collection.children
    layer.collection.hide_viewport = how == "collection disabled" and not is_on
    layer.exclude = how == "collection excluded" and not is_on
    bpy.context.view_layer.update()


def put_into_a_collection(face) -> bpy.types.Collection:
    scene = bpy.context.scene
    collection = bpy.data.collections.new("Set")
    scene.collection.children.link(collection)
    for obj in {face, control_of(face)} - {None}:
        scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


@pytest.mark.parametrize("how", SWITCHES)
def test_the_motion_of_a_face_that_is_switched_off_is_kept(bake, sheet, how):
    face = bake(sheet, to="CONTROLS")
    expected, collection = shown(face), put_into_a_collection(face)
    switch(face, how, False)
    assert bpy.ops.mimetic.remove_control_object() == {"FINISHED"}
    assert face.users_collection == (collection,)
    assert face.hide_viewport == (how == "object disabled")
    switch(face, how, True)
    assert_shown(face, expected)


@pytest.mark.parametrize("how", SWITCHES)
def test_a_face_that_is_switched_off_stays_where_it_stands(scene, bake, sheet, how):
    face = bake(sheet, to="CONTROLS")
    put_into_a_collection(face)
    expected = world_at(face, 30)
    scene.frame_set(12)
    switch(face, how, False)
    scene.frame_set(30)
    assert bpy.ops.mimetic.remove_control_object(use_curves=False) == {"FINISHED"}
    switch(face, how, True)
    np.testing.assert_allclose(world_at(face, 30), expected, atol=1e-6)


@pytest.mark.parametrize("how", SWITCHES)
def test_a_face_that_is_switched_off_gets_a_control_object(bake, sheet, how):
    face = bake(sheet)
    expected, collection = shown(face), put_into_a_collection(face)
    switch(face, how, False)
    bake(sheet, to="CONTROLS")
    assert control_of(face).users_collection == (collection,)
    switch(face, how, True)
    assert_shown(face, expected, METRES)
