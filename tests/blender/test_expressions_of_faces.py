# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of one face goes on another: all that sliders show, nothing of its person."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from test_gaze import looking  # noqa: F401

# Three muscles of the baked face in the group Lip Corners
SMILE, LEFT, RIGHT, CONTACT = "muscle_00.L", "muscle_07.L", "muscle_03.R", "contact.000"
GLANCE = {
    **{"gaze_yaw.L": 20.0, "gaze_yaw.R": 16.0, "gaze_pitch.L": -15.0, "gaze_pitch.R": -15.0},
    "lid_upper.L": 0.3,
}


def still(**values):
    from mimetic.library.expression import Expression

    row = np.array([list(values.values())])
    return Expression(list(values), row, 0 * row, 30.0)


@pytest.fixture
def head(scene):
    """Our own head, whose eyes turn by sliders that look up, down, in and out."""
    bpy.ops.mimetic.add_face()
    return bpy.context.active_object


@pytest.fixture
def face(extension, scene, looking):  # noqa: F811
    """A baked face at rest, whose eyes turn by five shapes each, with a private correction."""
    scene.render.fps, scene.render.fps_base = 25, 1.0
    out = extension("scene_out")
    out.bake(scene, looking, "take", with_units=True)
    obj = scene.mimetic.face
    key = obj.shape_key_add(name=CONTACT, from_mix=False)
    entry = obj.mimetic.shapes.add()
    entry.name = entry.shape = key.name
    entry.group = extension("native").shapes().CONTACT
    obj.data.shape_keys.animation_data_clear()
    out.sliders.rest(obj)
    out.canonical.select_only(bpy.context.view_layer, obj)
    return obj


def blocks(obj):
    return obj.data.shape_keys.key_blocks


def kept(extension, name, **how):
    """The kept expression by channel at its peak."""
    assert bpy.ops.mimetic.keep_expression(name=name, **how) == {"FINISHED"}
    return extension("scene_out").expressions.peak_values(bpy.data.actions[name])


def angles(obj):
    own = obj.mimetic
    return np.degrees([own.gaze_yaw_left, own.gaze_yaw_right, own.gaze_pitch_left])


def test_corrections_of_one_performance_are_not_kept_nor_moved(extension, scene, face):
    keys = blocks(face)
    for frame, value in ((1, 0.0), (5, 0.7), (9, 0.0)):
        for name in (SMILE, CONTACT):
            keys[name].value = value
            keys[name].keyframe_insert("value", frame=frame)
    motion = kept(extension, "motion", kind="MOTION", frame_first=1, frame_last=9)
    scene.frame_set(5)
    assert list(motion) == list(kept(extension, "still")) == [SMILE]
    # One that was kept with them before
    face.data.shape_keys.animation_data_clear()
    extension("scene_out").expressions.new_asset("old", still(**{SMILE: 0.2, CONTACT: 0.5}), 25.0)
    bpy.ops.mimetic.apply_expression(action="old")
    assert keys[CONTACT].value == pytest.approx(0.7) and keys[SMILE].value == pytest.approx(0.2)
    bpy.ops.mimetic.sequence_expression(action="old")
    scene.frame_set(15)
    assert keys[CONTACT].value == pytest.approx(0.7) and keys[SMILE].value > 0.1


def test_sliders_of_groups_and_those_beyond_1_are_kept(extension, face):
    keys = blocks(face)
    keys["Lip Corners"].value, keys["Lip Corners.R"].value = 0.5, -0.2
    keys[SMILE].value, keys["AU12.L"].value = 0.2, 1.6
    one = kept(extension, "corners")
    assert one[SMILE] == pytest.approx(0.7) and one[LEFT] == pytest.approx(0.5)
    assert one[RIGHT] == pytest.approx(0.3) and one["AU12.L"] == pytest.approx(1.6)
    assert not any(name.startswith("Lip") for name in one)


def test_a_gaze_in_degrees_turns_the_eyes_of_every_face(extension, scene, face, head):
    expressions = extension("scene_out").expressions
    expressions.new_asset("glance", still(**GLANCE), 25.0)
    bpy.ops.mimetic.apply_expression(action="glance")
    look = blocks(head)
    assert look["look_out.L"].value == pytest.approx(20 / 35, abs=1e-5)
    assert look["look_in.R"].value == pytest.approx(16 / 35, abs=1e-5)
    assert look["look_down.L"].value == pytest.approx(0.5, abs=1e-5)
    of_head = kept(extension, "of the head")
    extension("scene_out").canonical.select_only(bpy.context.view_layer, face)
    bpy.ops.mimetic.apply_expression(action="glance")
    np.testing.assert_allclose(angles(face), [20, 16, -15], atol=1e-3)
    carried = 0.02 * 15  # the lid goes along
    lid = blocks(face)["lid_upper.L"]
    assert lid.value == pytest.approx(0.3 + carried * 0.7, abs=1e-5)
    for own in (of_head, kept(extension, "of the face")):
        assert set(own) == set(GLANCE)
        assert [own[name] for name in GLANCE] == pytest.approx(list(GLANCE.values()), abs=1e-3)
    bpy.ops.mimetic.apply_expression(action="glance", is_mirrored=True)
    np.testing.assert_allclose(angles(face), [-16, -20, -15], atol=1e-3)


def test_strips_turn_the_eyes_and_compose_in_degrees(extension, scene, face):
    expressions = extension("scene_out").expressions
    expressions.new_asset("glance", still(**GLANCE), 25.0)
    scene.frame_set(1)
    bpy.ops.mimetic.sequence_expression(action="glance")
    scene.frame_set(13)
    np.testing.assert_allclose(angles(face), [20, 16, -15], atol=0.5)
    assert bpy.ops.mimetic.compose_expressions(name="composed") == {"FINISHED"}
    made = expressions.document_of(bpy.data.actions["composed"])
    assert set(GLANCE) <= set(made.channels) and np.abs(made.values).max() > 19
    assert not any(name.startswith("eye_") for name in made.channels)
    scene.frame_set(14)
    scene.frame_set(13)
    np.testing.assert_allclose(angles(face), [20, 16, -15], atol=0.5)


def test_a_curve_of_one_eye_keeps_both(extension, face):
    bpy.context.view_layer.objects.active = face
    key = blocks(face)["eye_left.L"]
    for frame, value in ((1, 0.0), (5, 0.4), (9, 0.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    one = kept(extension, "one eye", kind="MOTION", frame_first=1, frame_last=9)
    assert set(one) == {name for name in GLANCE if name.startswith("gaze_")} and one[
        "gaze_yaw.L"
    ] == pytest.approx(np.degrees(np.arcsin(0.4)), abs=0.01)


def test_what_a_face_cannot_do_is_told(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take")
    face = scene.mimetic.face
    face.data.shape_keys.animation_data_clear()
    extension("scene_out").expressions.new_asset("glance", still(**GLANCE), 25.0)
    result = bpy.context.window_manager
    for put in (bpy.ops.mimetic.apply_expression, bpy.ops.mimetic.sequence_expression):
        put(action="glance")
        assert f"{face.name} has no gaze_yaw.L, gaze_yaw.R" in result.mimetic_result


def test_an_expression_of_another_file_is_not_the_one_here_of_its_name(extension, tmp_path):
    new_asset = extension("scene_out").expressions.new_asset
    peak_values = extension("scene_out").expressions.peak_values
    assets = []
    for value in (0.9, 0.6):
        path = tmp_path / f"{value}.blend"
        new_asset("smile", still(**{SMILE: value}), 25.0)
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        bpy.data.actions.remove(bpy.data.actions["smile"])
        facts = {"full_library_path": str(path), "full_path": f"{path}/Action/smile"}
        assets.append(SimpleNamespace(id_type="ACTION", name="smile", local_id=None, **facts))
    new_asset("smile", still(**{SMILE: 0.2}), 25.0)
    chosen = extension("operators.chosen_expression").chosen
    picked = [chosen(SimpleNamespace(asset=asset), "") for asset in assets * 2]
    values = [peak_values(action)[SMILE] for action in picked]
    assert values == pytest.approx([0.9, 0.6, 0.9, 0.6])
    assert len(bpy.data.actions) == 3  # each appended once
