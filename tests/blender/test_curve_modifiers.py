# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifiers of curves play over their keys: edits of keys do not work them into these."""

import bpy
import numpy as np
import pytest
from test_curves import LEFT, RIGHT, keyed, rows, values

KINDS = {
    "GENERATOR": {"use_additive": True, "coefficients": (0.2, 0.0)},
    "NOISE": {"strength": 0.5, "scale": 1.5},
    "STEPPED": {"frame_step": 5},
    "CYCLES": {},
}


@pytest.fixture
def face(bake, performance):
    """Both sides have the left one's keys."""
    face = bake(performance)
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.mirror_curves(how="LEFT") == {"FINISHED"}
    return face


@pytest.fixture(params=KINDS)
def modifier(request, extension, face):
    modifier = rows(extension, face)[LEFT].curve.modifiers.new(request.param)
    for name, value in KINDS[request.param].items():
        setattr(modifier, name, value)
    return modifier


def test_keys_are_smoothed_as_without_the_modifier_however_often(extension, face, modifier):
    before = keyed(extension, face, LEFT)
    for _ in range(2):
        assert bpy.ops.mimetic.smooth_curves(seconds=0.1) == {"FINISHED"}
        after = keyed(extension, face, LEFT)
        np.testing.assert_allclose(after, keyed(extension, face, RIGHT), atol=1e-6)
    assert np.abs(after - before).max() > 1e-3
    assert not modifier.mute
    modifier.mute = True
    assert bpy.ops.mimetic.smooth_curves(seconds=0.1) == {"FINISHED"}
    assert modifier.mute


def test_the_mean_of_both_sides_is_that_of_their_keys(extension, face, modifier):
    before = keyed(extension, face, LEFT)
    assert bpy.ops.mimetic.mirror_curves(how="BOTH", share=0.5) == {"FINISHED"}
    for shape in (LEFT, RIGHT):
        np.testing.assert_allclose(keyed(extension, face, shape), before, atol=1e-6)


@pytest.mark.parametrize("frame", [12, 53])
def test_what_plays_in_this_frame_stays_and_is_at_rest(extension, scene, face, modifier, frame):
    """Before the end of the keys and after it, where some modifiers repeat them."""
    scene.frame_set(frame)
    before = values(extension, face, LEFT, [frame])
    options = {"factor": 0.5, "about": "FRAME", "use_limits": False}
    assert bpy.ops.mimetic.exaggerate_curves(**options) == {"FINISHED"}
    np.testing.assert_allclose(values(extension, face, LEFT, [frame]), before, atol=1e-5)
    for _ in range(2):
        options = {"by": "NEUTRAL", "use_limits": False}
        assert bpy.ops.mimetic.offset_curves(**options) == {"FINISHED"}
        np.testing.assert_allclose(values(extension, face, LEFT, [frame]), 0, atol=1e-5)


def test_at_rest_within_limits_is_the_same_however_often(extension, scene, face, modifier):
    scene.frame_set(12)
    assert bpy.ops.mimetic.offset_curves(by="NEUTRAL") == {"FINISHED"}
    once = keyed(extension, face, LEFT)
    assert bpy.ops.mimetic.offset_curves(by="NEUTRAL") == {"FINISHED"}
    np.testing.assert_allclose(keyed(extension, face, LEFT), once, atol=1e-6)
