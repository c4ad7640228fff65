# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that were duplicated: which of two a bake goes to, and what two with one mesh are told."""

import dataclasses

import bpy
import pytest
from last_result import result
from test_takes import rows

pytestmark = pytest.mark.oldest_and_newest

TOLD = "'s sliders are those of {}, too, as they share a mesh"


@pytest.fixture
def actors(sheet):
    """What was captured of Anna, and of Ben."""
    return [
        dataclasses.replace(sheet, footage=[f"{name}.mp4", f"1-{name[0] * 64}"])
        for name in ("anna", "ben")
    ]


def select(obj) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def put_last(scene, obj) -> None:
    """In a collection of its own, whose objects come after the scene's."""
    cast = bpy.data.collections.new("Cast")
    scene.collection.children.link(cast)
    cast.objects.link(obj)
    scene.collection.objects.unlink(obj)


@pytest.fixture
def copied(scene, bake, actors):
    """Anna's face is copied some way and put last; then Ben's becomes the scene's."""

    def run(copy) -> bpy.types.Object:
        face = bake(actors[0], "anna")
        select(face)
        assert copy() == {"FINISHED"}
        put_last(scene, face)
        select(scene.camera)
        assert bake(actors[1], "ben") != face
        return face

    return run


def test_a_bake_goes_to_the_active_one_of_two(extension, scene, copied, actors):
    face = copied(lambda: bpy.ops.object.duplicate())
    find = extension("scene_out").face.find
    (other,) = (o for o in scene.objects if o.name.startswith(face.name + ".001"))
    for active in (face, other, face):
        select(active)
        assert find(scene, actors[0]) == active


def test_a_copy_to_compare_by_takes_no_bake_of_the_footage(scene, copied, bake, actors):
    face = copied(lambda: bpy.ops.mimetic.compare_take())
    assert bake(actors[0], "again") == face
    assert rows(face) == ["anna", "anna.002"]


@pytest.fixture
def twin(bake, sheet):
    """The duplicate with linked data (Alt D) of a baked face, active."""
    select(bake(sheet))
    assert bpy.ops.object.duplicate(linked=True) == {"FINISHED"}
    select(bpy.context.active_object)
    return bpy.context.active_object


def test_linked_data_is_told_by_what_moves_both(scene, twin, bake, sheet):
    told = twin.name + TOLD.format(scene.mimetic.face.name)
    bake(sheet, "again")
    assert rows(twin) == ["hero", "again"]
    for name, take in (("play_take", "hero"), ("remove_take", "again")):
        assert told in result()["message"]
        assert getattr(bpy.ops.mimetic, name)(take=take) == {"FINISHED"}
    assert told in result()["message"]


def test_data_of_its_own_is_told_by_nothing(twin, bake, sheet):
    twin.data = twin.data.copy()
    bake(sheet, "again")
    assert rows(twin) == ["hero", "again"] and TOLD[:12] not in result()["message"]
    bpy.ops.mimetic.play_take(take="hero")
    assert TOLD[:12] not in result()["message"]


def test_a_duplicate_that_was_deleted_is_not_told(twin, scene, bake, sheet):
    face = scene.mimetic.face
    scene.collection.objects.unlink(twin)
    select(face)
    bpy.ops.mimetic.play_take(take="hero")
    assert result()["message"] == "hero plays on Face"
