# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job writes to is renamed or deleted while it works: a line says so, and no traceback."""

import bpy
import pytest

pytestmark = pytest.mark.newest


def rename(obj) -> None:
    obj.name = "Renamed"


def delete(obj) -> None:
    bpy.data.objects.remove(obj)


@pytest.fixture
def meanwhile(extension, monkeypatch):
    """Has something done to an object between a job's start and its writing."""

    def do(change, obj) -> None:
        takes = extension("takes")
        load = takes.load

        def load_late(take):
            monkeypatch.setattr(takes, "load", load)
            change(obj)
            return load(take)

        monkeypatch.setattr(takes, "load", load_late)

    return do


def refusal(operator) -> str:
    with pytest.raises(RuntimeError) as failure:
        operator()
    return str(failure.value).strip()


@pytest.mark.parametrize("change", [rename, delete])
def test_the_target_of_the_heads_motion(scene, bake, performance, meanwhile, change):
    bake(performance)
    empty = bpy.data.objects.new("Rig", None)
    scene.collection.objects.link(empty)
    scene.mimetic.head.target = empty
    meanwhile(change, empty)
    refused = refusal(bpy.ops.mimetic.bake_head)
    assert refused == "Error: Rig was deleted or renamed meanwhile: begin again"


@pytest.mark.parametrize("change", [rename, delete])
def test_a_character(bake, performance, meanwhile, change):
    bpy.context.view_layer.objects.active = bake(performance)
    bpy.ops.object.duplicate()
    copy = bpy.context.active_object
    name = copy.name
    meanwhile(change, copy)
    refused = refusal(bpy.ops.mimetic.bake)
    assert refused == f"Error: {name} was deleted or renamed meanwhile: begin again"
