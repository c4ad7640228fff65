# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of the face's curves, on shape keys and on a control object, at any pair of rates."""

import dataclasses

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from test_control_object import baked
from test_gaze import looking  # noqa: F401

RATES = ((24, 1.0), (25, 1.0), (30, 1.001), (60, 1.0))
LEFT, RIGHT = "muscle_00.L", "muscle_00.R"


@pytest.fixture(params=["KEYS", "CONTROLS"])
def face(request, extension, scene, sheet):
    face = baked(extension, scene, sheet, use_controls=request.param == "CONTROLS")
    bpy.context.view_layer.objects.active = face
    return face


def baked_at(extension, scene, performance, rate):
    """A face on shape keys in a scene of another rate than the performance's."""
    scene.render.fps, scene.render.fps_base = rate
    extension("scene_out").bake(scene, performance, "take", subdivision=0)
    bpy.context.view_layer.objects.active = scene.mimetic.face
    return scene.mimetic.face


def rows(extension, face) -> dict:
    return {row.shape: row for row in extension("scene_out").face_curves.of(face)}


def values(extension, face, shape: str, frames) -> np.ndarray:
    """Of a shape, whatever its curve's unit."""
    row = rows(extension, face)[shape]
    return np.array([row.curve.evaluate(frame) for frame in frames]) / row.unit


def keyed(extension, face, shape: str) -> np.ndarray:
    row = rows(extension, face)[shape]
    return np.array([point.co[:] for point in row.curve.keyframe_points]) / (1, row.unit)


def select(extension, face, shapes, first=0.0, last=1e6) -> None:
    """These curves and their keys between two frames, nothing else."""
    for row in rows(extension, face).values():
        row.curve.select = row.shape in shapes
        for point in row.curve.keyframe_points:
            is_in = row.shape in shapes and first <= point.co.x <= last
            point.select_control_point = is_in


def test_smoothing_takes_jitter_away_and_leaves_keys_where_they_are(extension, face):
    row = rows(extension, face)[LEFT]
    before = keyed(extension, face, LEFT)
    for i, point in enumerate(row.curve.keyframe_points):
        point.co.y += 0.02 * (-1) ** i
    row.curve.update()
    assert bpy.ops.mimetic.smooth_curves(seconds=0.06) == {"FINISHED"}
    after = keyed(extension, face, LEFT)
    np.testing.assert_allclose(after[:, 0], before[:, 0])
    assert np.abs(after - before)[3:-3, 1].max() < 0.01
    assert 0.015 < result()["error"] < 0.3
    assert result()["num_curves"] >= 36


def test_lids_are_smoothed_where_they_are_asked_for_alone(extension, face):
    lid = "lid_upper.L"
    row = rows(extension, face)[lid]
    row.curve.keyframe_points[20].co.y += 0.5
    row.curve.update()
    before = keyed(extension, face, lid)
    assert bpy.ops.mimetic.smooth_curves() == {"FINISHED"}
    np.testing.assert_array_equal(keyed(extension, face, lid), before)
    options = [{"use_lids_and_gaze": True}, {"group": row.group}]
    for i, option in enumerate(options):
        assert bpy.ops.mimetic.smooth_curves(**option) == {"FINISHED"}
        after = keyed(extension, face, lid)
        assert after[20, 1] < before[20, 1] - 0.02, i
        before = after


@pytest.mark.parametrize("rate", RATES)
def test_smoothing_is_the_same_at_every_scene_rate(extension, scene, sheet, rate):
    jitter = 0.05 * (-1.0) ** np.arange(40)[:, None]
    shaken = dataclasses.replace(sheet, activations=np.clip(sheet.activations + jitter, 0, 1))
    face = baked_at(extension, scene, shaken, rate)
    at = 1 + rate[0] / rate[1] / sheet.fps * np.arange(40)
    raw = values(extension, face, LEFT, at)
    assert bpy.ops.mimetic.smooth_curves(seconds=0.1) == {"FINISHED"}
    parts = extension("native").curve_settings()
    expected = parts.edited(shaken, parts.CurveSettings(smoothing=0.1)).activations[:, 0]
    assert np.abs(raw - expected)[5:-5].max() > 0.02
    assert np.abs(values(extension, face, LEFT, at) - expected)[5:-5].max() < 0.003


def test_few_keys_are_smoothed_as_dense_ones_are_between_them_too(extension, scene, sheet):
    events = np.interp(np.arange(40), [0, 12, 16, 36, 39], [0, 0, 0.4, 0.5, 0.5])
    moved = dataclasses.replace(sheet, activations=np.repeat(events[:, None], 36, axis=1))
    face = baked_at(extension, scene, moved, (25, 1.0))
    assert bpy.ops.mimetic.reduce_keys(tolerance=0.02) == {"FINISHED"}
    before = keyed(extension, face, LEFT)
    assert bpy.ops.mimetic.smooth_curves(seconds=0.08) == {"FINISHED"}
    np.testing.assert_array_equal(keyed(extension, face, LEFT)[:, 0], before[:, 0])
    assert len(before) < 10
    parts = extension("native").curve_settings()
    expected = parts.edited(moved, parts.CurveSettings(smoothing=0.08)).activations[:, 0]
    smooth = values(extension, face, LEFT, np.arange(1, 41))
    assert np.abs(smooth - expected).max() < 0.03


def test_how_far_contact_was_smoothed_is_not_told_as_an_activation(extension, face):
    key = face.shape_key_add(name="contact.000", from_mix=False)
    entry = face.mimetic.shapes.add()
    entry.name = entry.shape = key.name
    entry.group = extension("native").shapes().CONTACT
    for frame in range(1, 41):
        key.value = frame % 2
        key.keyframe_insert("value", frame=frame)
    assert bpy.ops.mimetic.smooth_curves(seconds=0.1) == {"FINISHED"}
    assert abs(values(extension, face, key.name, [20])[0] - 0.5) < 0.1
    assert result()["error"] < 0.3
    select(extension, face, {key.name})
    assert bpy.ops.mimetic.smooth_curves(seconds=0.1, on="CURVES") == {"FINISHED"}
    assert result()["error"] is None
    assert result()["message"] == "1 curve smoothed"


def test_few_keys_of_selected_keys_leave_the_others(extension, face):
    before = keyed(extension, face, LEFT)
    other = keyed(extension, face, RIGHT)
    select(extension, face, {LEFT}, 10, 30)
    assert bpy.ops.mimetic.reduce_keys(tolerance=0.05, on="KEYS") == {"FINISHED"}
    after = keyed(extension, face, LEFT)
    assert result()["num_keys"] < result()["num_keys_before"] == 21
    outside = (before[:, 0] < 10) | (before[:, 0] > 30)
    kept = (after[:, 0] < 10) | (after[:, 0] > 30)
    np.testing.assert_array_equal(after[kept], before[outside])
    np.testing.assert_array_equal(keyed(extension, face, RIGHT), other)
    frames = np.arange(1, 41)
    assert np.abs(values(extension, face, LEFT, frames) - before[:, 1]).max() <= 0.051


def test_one_group_on_one_side_is_exaggerated_within_its_limits(extension, face):
    group = rows(extension, face)[LEFT].group
    before = {shape: keyed(extension, face, shape) for shape in rows(extension, face)}
    assert bpy.ops.mimetic.exaggerate_curves(factor=1.5, group=group, side="LEFT") == {"FINISHED"}
    for shape, row in rows(extension, face).items():
        after, meant = keyed(extension, face, shape), before[shape].copy()
        if row.group == group and shape.endswith(".L"):
            meant[:, 1] = np.clip(1.5 * meant[:, 1], row.lowest, row.highest)
        np.testing.assert_allclose(after, meant, atol=1e-6, err_msg=shape)
    assert result()["num_keys_limited"] > 0


def test_what_the_face_does_in_this_frame_stays_as_it_is_exaggerated(extension, scene, face):
    scene.frame_set(12)
    before = keyed(extension, face, LEFT)
    options = {"factor": 0.5, "about": "FRAME"}
    assert bpy.ops.mimetic.exaggerate_curves(**options) == {"FINISHED"}
    after = keyed(extension, face, LEFT)
    np.testing.assert_allclose(after[11], before[11], atol=1e-6)
    np.testing.assert_allclose(after[:, 1], 0.5 * (before[:, 1] + before[11, 1]), atol=1e-6)


def test_the_jaw_is_offset_by_its_value_whatever_drives_it(extension, face):
    before = keyed(extension, face, "jaw_open")
    group = rows(extension, face)["jaw_open"].group
    options = {"amount": 0.1, "group": group, "use_limits": False}
    assert bpy.ops.mimetic.offset_curves(**options) == {"FINISHED"}
    after = keyed(extension, face, "jaw_open")
    np.testing.assert_allclose(after[:, 1], before[:, 1] + 0.1, atol=1e-5)


def test_the_face_is_at_rest_in_its_neutral_frame(extension, scene, face):
    scene.frame_set(7)
    assert bpy.ops.mimetic.offset_curves(by="NEUTRAL") == {"FINISHED"}
    for shape, row in rows(extension, face).items():
        if row.group != "Detail":
            assert abs(values(extension, face, shape, [7])[0]) < 1e-6, shape
    keys = face.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.shape_keys
    assert abs(keys.key_blocks[LEFT].value) < 1e-6  # seen at once


@pytest.mark.parametrize(
    ("how", "of_left", "of_right", "turn"),
    [
        ("SWAP", (0, 1), (1, 0), -1),
        ("LEFT", (1, 0), (1, 0), 1),
        ("RIGHT", (0, 1), (0, 1), 1),
        ("BOTH", (0.5, 0.5), (0.5, 0.5), 0),
    ],
)
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_the_sides_do_what_the_mirror_says(extension, face, how, of_left, of_right, turn, share):
    frames = np.arange(1, 41)
    shapes = (LEFT, RIGHT, "jaw_side")
    left, right, side = (values(extension, face, shape, frames) for shape in shapes)
    assert bpy.ops.mimetic.mirror_curves(how=how, share=share) == {"FINISHED"}

    def blended(own, weights):
        return (1 - share) * own + share * (weights[0] * left + weights[1] * right)

    after = [values(extension, face, shape, frames) for shape in shapes]
    np.testing.assert_allclose(after[0], blended(left, of_left), atol=1e-5)
    np.testing.assert_allclose(after[1], blended(right, of_right), atol=1e-5)
    np.testing.assert_allclose(after[2], side * (1 - share + share * turn), atol=1e-5)


@pytest.mark.parametrize("use_controls", [False, True])
@pytest.mark.parametrize("how", ["LEFT", "RIGHT", "BOTH"])
def test_eyes_look_one_way_whoever_is_followed(
    extension,
    scene,
    looking,  # noqa: F811
    how,
    use_controls,
):
    face = baked(extension, scene, looking, use_controls=use_controls)
    bpy.context.view_layer.objects.active = face
    frames = np.arange(1, 41)
    gaze = [shape for shape, row in rows(extension, face).items() if row.group == "Gaze"]
    before = [values(extension, face, shape, frames) for shape in gaze]
    assert len(gaze) > 1 and np.ptp(before) > 0
    assert bpy.ops.mimetic.mirror_curves(how=how) == {"FINISHED"}
    after = [values(extension, face, shape, frames) for shape in gaze]
    np.testing.assert_array_equal(after, before)


def test_few_keys_are_mixed_exactly(extension, face):
    assert bpy.ops.mimetic.reduce_keys(tolerance=0.03) == {"FINISHED"}
    frames = np.linspace(1, 40, 90)
    left, right = (values(extension, face, shape, frames) for shape in (LEFT, RIGHT))
    assert bpy.ops.mimetic.mirror_curves(how="BOTH") == {"FINISHED"}
    after = values(extension, face, LEFT, frames)
    np.testing.assert_allclose(after, 0.5 * (left + right), atol=2e-3)
    assert len(keyed(extension, face, LEFT)) < 30


@pytest.mark.parametrize("rate", RATES)
def test_twice_as_long_plays_the_same_later_with_the_head(extension, scene, sheet, rate):
    face = baked_at(extension, scene, sheet, rate)
    at = 1 + rate[0] / rate[1] / sheet.fps * np.arange(40)
    before = {shape: values(extension, face, shape, at) for shape in rows(extension, face)}
    head = extension("compat").curves(face).fcurves[0]
    places = [head.evaluate(frame) for frame in at]
    assert bpy.ops.mimetic.retime_curves(factor=2.0, frames_later=5.0) == {"FINISHED"}
    later = at[0] + 5 + 2 * (at - at[0])
    for shape, expected in before.items():
        np.testing.assert_allclose(values(extension, face, shape, later), expected, atol=2e-5)
    head = extension("compat").curves(face).fcurves[0]
    np.testing.assert_allclose([head.evaluate(frame) for frame in later], places, atol=1e-5)
    assert result()["scene_frames"] == pytest.approx([later[0], later[-1]], abs=1e-3)


def test_selected_keys_are_retimed_and_what_comes_after_moves_along(extension, face):
    before, other = (keyed(extension, face, shape) for shape in (LEFT, RIGHT))
    select(extension, face, {LEFT}, 10, 20)
    options = {"factor": 1.5, "on": "KEYS", "use_head": False}
    assert bpy.ops.mimetic.retime_curves(**options) == {"FINISHED"}
    after = keyed(extension, face, LEFT)[:, 0]
    frames = before[:, 0]
    expected = frames + 0.5 * (np.clip(frames, 10, 20) - 10)
    np.testing.assert_allclose(after, expected, atol=1e-5)
    np.testing.assert_array_equal(keyed(extension, face, RIGHT), other)


def test_nothing_selected_and_unknown_groups_are_said_and_change_nothing(extension, face):
    select(extension, face, set())
    before = keyed(extension, face, LEFT)
    for on, what in (("KEYS", "no key"), ("CURVES", "no curve")):
        with pytest.raises(RuntimeError, match=f"{what} is selected"):
            bpy.ops.mimetic.smooth_curves(on=on)
    with pytest.raises(RuntimeError, match="no curves of a group Nose: it has Lip Corners"):
        bpy.ops.mimetic.exaggerate_curves(group="Nose")
    with pytest.raises(RuntimeError, match="no key is selected"):
        bpy.ops.mimetic.mirror_curves(on="KEYS")
    np.testing.assert_array_equal(keyed(extension, face, LEFT), before)


def test_a_locked_curve_is_left_alone(extension, face):
    rows(extension, face)[LEFT].curve.lock = True
    before, other = (keyed(extension, face, shape) for shape in (LEFT, RIGHT))
    assert bpy.ops.mimetic.exaggerate_curves(factor=0.5) == {"FINISHED"}
    assert bpy.ops.mimetic.mirror_curves(how="RIGHT") == {"FINISHED"}
    np.testing.assert_array_equal(keyed(extension, face, LEFT), before)
    np.testing.assert_allclose(keyed(extension, face, RIGHT)[:, 1], 0.5 * other[:, 1], atol=1e-6)


def test_one_undo_takes_an_edit_back(extension, face):
    name, before = face.name, keyed(extension, face, LEFT)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.exaggerate_curves("EXEC_DEFAULT", True, factor=0.3) == {"FINISHED"}
    bpy.ops.ed.undo()
    face = bpy.data.objects[name]
    np.testing.assert_array_equal(keyed(extension, face, LEFT), before)


def test_a_bake_edits_curves_as_it_keys_them(extension, scene, sheet, sheet_file):
    scene.mimetic.performance_path = str(sheet_file)
    options = {"smoothing": 0.1, "neutral_frame": 5, "exaggeration": 1.5}
    options["group_exaggeration"] = "Lip Corners=0.5"
    assert bpy.ops.mimetic.bake(**options, mirror="SWAP") == {"FINISHED"}
    parts = extension("native").curve_settings()
    expected = parts.edited(sheet, parts.settings_of(*options.values(), "swap"))
    face = scene.mimetic.face
    for name, column in zip(sheet.muscles, expected.activations.T, strict=True):
        np.testing.assert_allclose(keyed(extension, face, name)[:, 1], column, atol=1e-6)
    with pytest.raises(RuntimeError, match="neutral frame 400 is not in the performance"):
        bpy.ops.mimetic.bake(neutral_frame=400)


def test_the_panel_has_every_edit_and_greyed_ones_say_why(extension, scene, sheet):
    operators = [name for name in dir(bpy.ops.mimetic) if name.endswith("_curves")]
    assert len(operators) == 5
    for name in (*operators, "reduce_keys"):
        assert not getattr(bpy.ops.mimetic, name).poll()
        with pytest.raises(RuntimeError, match="Press Bake or Add Face"):
            getattr(bpy.ops.mimetic, name)()
    bpy.context.view_layer.objects.active = baked(extension, scene, sheet)
    texts = drawn("MIMETIC_PT_curves")
    assert "keys" in texts
    for name in (*operators, "reduce_keys"):
        assert f"mimetic.{name}" in texts


def test_a_groups_own_slider_is_scaled_mirrored_and_moved_as_its_muscles(scene):
    bpy.ops.mimetic.add_face()
    face = bpy.context.active_object
    keys = face.data.shape_keys.key_blocks
    left = next(keys[row.name] for row in face.mimetic.groups if row.name.endswith(".L"))
    group = left.name.removesuffix(".L")
    right = keys[f"{group}.R"]
    for frame, value in ((1, 0.0), (10, 0.4)):
        left.value, right.value = value, 0.0
        for key in (left, right):
            key.keyframe_insert("value", frame=frame)
    scene.frame_set(10)
    bpy.ops.mimetic.exaggerate_curves(factor=2.0, group=group)
    assert (left.value, right.value) == pytest.approx((0.8, 0.0), abs=1e-5)
    bpy.ops.mimetic.mirror_curves(how="SWAP", group=group)
    assert (left.value, right.value) == pytest.approx((0.0, 0.8), abs=1e-5)
    bpy.ops.mimetic.offset_curves(amount=0.1, group=group)
    assert (left.value, right.value) == pytest.approx((0.1, 0.9), abs=1e-5)
