# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that have samples instead of keys are left alone, and said to be."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_curves import LEFT, RIGHT, keyed, rows, select, values

FRAMES = np.arange(1, 41)
WHY = "samples instead of keys (Graph Editor, Channel > Samples to Keys)"


@pytest.fixture
def face(bake, performance):
    face = bake(performance)
    bpy.context.view_layer.objects.active = face
    return face


def to_samples(extension, face, *shapes) -> None:
    for shape, row in rows(extension, face).items():
        if shape in shapes or not shapes:
            row.curve.convert_to_samples(1, 41)


@pytest.mark.parametrize("side", ["BOTH", "LEFT"])
@pytest.mark.parametrize("share", [1.0, 0.5])
@pytest.mark.parametrize("how", ["SWAP", "LEFT", "RIGHT", "BOTH"])
def test_the_mirror_leaves_them_alone_with_their_other_side(extension, face, how, share, side):
    to_samples(extension, face, RIGHT)
    before = [values(extension, face, shape, FRAMES) for shape in (LEFT, RIGHT)]
    other = keyed(extension, face, "muscle_01.L")
    options = {"how": how, "share": share, "side": side}
    assert bpy.ops.mimetic.mirror_curves(**options) == {"FINISHED"}
    after = [values(extension, face, shape, FRAMES) for shape in (LEFT, RIGHT)]
    np.testing.assert_array_equal(after, before)
    assert result()["message"].endswith(f" curves mirrored; {RIGHT}: {WHY}")
    if how != "LEFT":
        assert len(keyed(extension, face, "muscle_01.L")) == len(other)
        assert np.abs(keyed(extension, face, "muscle_01.L") - other).max() > 0.005


def test_a_curve_without_keys_gives_its_other_side_none(extension, face):
    rows(extension, face)[RIGHT].curve.keyframe_points.clear()
    before = keyed(extension, face, LEFT)
    for share in (1.0, 0.5):
        assert bpy.ops.mimetic.mirror_curves(how="RIGHT", share=share) == {"FINISHED"}
        np.testing.assert_array_equal(keyed(extension, face, LEFT), before)


def test_a_head_of_samples_is_not_said_to_have_moved(extension, face):
    for curve in extension("compat").curves(face).fcurves:
        curve.convert_to_samples(1, 41)
    num_curves = len(rows(extension, face))
    assert bpy.ops.mimetic.retime_curves(frames_later=20.0) == {"FINISHED"}
    assert result()["scene_frames"] == [21, 60] and result()["num_curves"] == num_curves
    assert result()["message"].endswith(f"from frame 21 to 60; the head: {WHY}")
    assert bpy.ops.mimetic.retime_curves(use_head=False) == {"FINISHED"}
    assert WHY not in result()["message"]


def test_every_edit_names_those_that_it_would_change(extension, face):
    to_samples(extension, face, LEFT, RIGHT)
    before = values(extension, face, LEFT, FRAMES)
    operators = [name for name in dir(bpy.ops.mimetic) if name.endswith("_curves")]
    for name in (*operators, "reduce_keys"):
        assert getattr(bpy.ops.mimetic, name)() == {"FINISHED"}
        assert result()["message"].endswith(f"; {LEFT}, {RIGHT}: {WHY}"), name
    np.testing.assert_array_equal(values(extension, face, LEFT, FRAMES), before)
    assert bpy.ops.mimetic.reduce_keys(side="LEFT") == {"FINISHED"}
    assert result()["message"].endswith(f"; {LEFT}: {WHY}")
    select(extension, face, {"muscle_01.L"})
    for on in ("CURVES", "KEYS"):
        assert bpy.ops.mimetic.reduce_keys(on=on) == {"FINISHED"}
        assert WHY not in result()["message"]


def test_where_there_is_nothing_else_it_is_said_why(extension, face):
    to_samples(extension, face)
    with pytest.raises(RuntimeError, match=r"and .* more: samples instead of keys"):
        bpy.ops.mimetic.smooth_curves()
    select(extension, face, {LEFT})
    with pytest.raises(RuntimeError, match=f"{LEFT}: samples instead of keys"):
        bpy.ops.mimetic.smooth_curves(on="CURVES")
    with pytest.raises(RuntimeError, match="no key is selected"):
        bpy.ops.mimetic.smooth_curves(on="KEYS")
