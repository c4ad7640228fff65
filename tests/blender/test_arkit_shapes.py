# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's shapes that a head was given follow its landmarks; what was changed by hand stays."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_attach_muscles import new_head, offsets_of, put_landmarks

pytestmark = pytest.mark.newest


@pytest.fixture
def head(parts):
    """With muscles and ARKit's shapes."""
    head = new_head(parts[0], parts[1].tolist())
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    return head


def drag(head, name: str, down: float) -> None:
    """By so many centimetres."""
    next(mark for mark in head.children if mark.mimetic.landmark == name).location[2] -= down
    bpy.context.view_layer.update()


def shapes_of(head) -> dict[str, np.ndarray]:
    return {entry.shape: offsets_of(head, entry.name) for entry in head.mimetic.units}


def test_they_follow_a_landmark_as_if_they_were_new(head, parts):
    before = shapes_of(head)
    assert len(before) == 52
    order = list(head.data.shape_keys.key_blocks.keys())
    head.data.shape_keys.key_blocks["jawOpen"].value = 0.5
    drag(head, "mouth_corner.L", 0.6)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    after = shapes_of(head)
    assert np.abs(after["mouthSmileLeft"] - before["mouthSmileLeft"]).max() > 0.05
    assert head.data.shape_keys.key_blocks["jawOpen"].value == pytest.approx(0.5)
    assert list(head.data.shape_keys.key_blocks.keys()) == order
    fresh = new_head(parts[0], parts[1].tolist())
    put_landmarks(fresh, parts)
    drag(fresh, "mouth_corner.L", 0.6)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    for name, expected in shapes_of(fresh).items():
        np.testing.assert_allclose(after[name], expected, atol=1e-4, err_msg=name)


def test_what_was_changed_by_hand_stays_and_is_named(head):
    blocks = head.data.shape_keys.key_blocks
    blocks["mouthPucker"].name = "Kuss"
    blocks["cheekPuff"].points[7].co.x += 1
    blocks["jawOpen"].slider_max = 2.0
    head.shape_key_remove(blocks["tongueOut"])
    own = head.shape_key_add(name="noseSneerLeft.001", from_mix=False)
    sculpted, pucker = offsets_of(head, "cheekPuff"), offsets_of(head, "Kuss")
    drag(head, "mouth_corner.R", 0.6)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    message = result()["message"]
    for words in ("the name Kuss of mouthPucker", "shape of cheekPuff", "limits of jawOpen"):
        assert words in message
    assert "mouthPucker" not in blocks and "tongueOut" not in blocks
    assert np.abs(offsets_of(head, "Kuss") - pucker).max() > 0.01
    np.testing.assert_array_equal(offsets_of(head, "cheekPuff"), sculpted)
    assert blocks["jawOpen"].slider_max == 2.0
    assert own.name == "noseSneerLeft.001" and not np.abs(offsets_of(head, own.name)).any()
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    assert "tongueOut" in blocks and "mouthPucker" not in blocks
    assert result()["num_sliders"] == 52
    np.testing.assert_array_equal(offsets_of(head, "cheekPuff"), sculpted)
    assert "stay as they were" not in result()["message"]


def test_a_head_without_muscles_is_made_its_shapes_again(parts):
    head = new_head(parts[0], parts[1].tolist())
    put_landmarks(head, parts)
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    before = shapes_of(head)
    drag(head, "mouth_corner.L", 0.6)
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    assert len(head.data.shape_keys.key_blocks) == 1 + 52
    assert np.abs(shapes_of(head)["mouthSmileLeft"] - before["mouthSmileLeft"]).max() > 0.05


def test_undo_brings_the_shapes_of_before(head):
    before = shapes_of(head)
    bpy.ops.ed.undo_push(message="given")
    drag(head, "chin", 1.0)
    bpy.ops.ed.undo_push(message="dragged")
    assert bpy.ops.mimetic.attach_muscles("EXEC_DEFAULT", True) == {"FINISHED"}
    assert np.abs(shapes_of(head)["jawOpen"] - before["jawOpen"]).max() > 1e-3
    bpy.ops.ed.undo()
    for name, expected in shapes_of(bpy.data.objects["Bust"]).items():
        np.testing.assert_array_equal(expected, before[name])
