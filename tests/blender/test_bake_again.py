# SPDX-License-Identifier: GPL-3.0-or-later
"""A head with own controls and muscles, baked on the ones after the others: it moves once."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_bake_bound import evaluated
from test_own_controls import UNITS, character, key_curves, loaded, played  # noqa: F401

pytestmark = pytest.mark.oldest_and_newest

FRAME = 20


@pytest.fixture
def head(loaded):  # noqa: F811
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    rest(loaded)
    return loaded


def rest(head) -> None:
    for key in head.data.shape_keys.key_blocks:  # which Blender 5 makes with the value 1
        key.value = 0


def bake(kind: str) -> None:
    make = bpy.ops.mimetic.bake if kind == "muscles" else bpy.ops.mimetic.bake_controls
    assert make(use_head_motion=False) == {"FINISHED"}
    bpy.context.scene.frame_set(FRAME)


@pytest.mark.parametrize("kinds", [("muscles", "own"), ("own", "muscles")])
def test_what_the_other_bake_drove_is_at_rest(extension, scene, head, kinds):
    first, second = kinds
    bake(second)
    alone, expected = set(key_curves(extension, head)), evaluated(head)
    head.data.shape_keys.animation_data.action = None
    rest(head)
    bake(first)
    before = key_curves(extension, head)
    assert not alone & before.keys()
    bake(second)
    assert key_curves(extension, head).keys() == alone
    np.testing.assert_allclose(evaluated(head), expected, atol=1e-3)  # cm
    moved = f"{len(before)} sliders of Hero that an earlier take moved are at rest now"
    assert moved in result()["message"] + " ".join(result().get("left_out", ()))
    assert bpy.ops.mimetic.play_take(take=head.mimetic.takes[-2].name) == {"FINISHED"}
    assert key_curves(extension, head).keys() == before.keys()


def test_a_curve_that_was_edited_by_hand_stays(extension, head):
    bake("own")
    keys = head.data.shape_keys
    jaw = keys.key_blocks["jawOpen"].path_from_id("value")
    curve = extension("compat").curves(keys).fcurves.find(jaw)
    curve.keyframe_points[3].co[1] = 0.9
    curve.update()
    bake("muscles")
    assert key_curves(extension, head).keys() & set(UNITS) == {"jawOpen"}


def test_teeth_that_moved_along_are_at_rest(extension, scene, head):
    teeth = bpy.data.objects.new("Teeth", bpy.data.meshes.new("Teeth"))
    teeth.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    teeth.parent = head
    scene.collection.objects.link(teeth)
    for name in ("Basis", "jawOpen"):
        teeth.shape_key_add(name=name, from_mix=False)
    bpy.context.view_layer.objects.active = head
    bake("own")
    assert teeth.data.shape_keys.key_blocks["jawOpen"].value > 0.01
    bake("muscles")
    assert teeth.data.shape_keys.key_blocks["jawOpen"].value == 0
    assert key_curves(extension, teeth) == {}
    first = head.mimetic.takes[-2].name
    assert bpy.ops.mimetic.play_take(take=first) == {"FINISHED"}
    assert key_curves(extension, teeth).keys() == {"jawOpen"}
