# SPDX-License-Identifier: GPL-3.0-or-later
"""Which bones are of a face, and what their values key."""

import numpy as np
import pytest
from mimetic.retarget.bone_channels import (
    PROPORTIONAL,
    channels_of,
    eye_bones,
    eye_channels_of,
    face_bones,
    reach,
    turns,
)


def test_bones_of_a_face_are_known_and_those_of_the_rigs_mechanism_are_not():
    rigify = [
        "jaw_master",
        "brow.T.L",
        "lid.B.R.002",
        "lips.L",
        "DEF-lid.B.L",
        "ORG-jaw",
        "MCH-lip",
    ]
    others = ["spine.006", "head", "hand.L", "c_lips_smile.l", "LowerJaw", "eye.L"]
    assert face_bones([*rigify, *others]) == [*rigify[:4], "c_lips_smile.l", "LowerJaw"]


def test_words_that_only_hold_a_face_in_them_are_none():
    strangers = ["slide", "collider.L", "hair_clip", "machine", "flip", "solid_01", "browser"]
    assert face_bones(strangers) == []
    others = ["lUpperLid", "CC_Base_JawRoot", "upperlip.L", "FACIAL_L_LipCorner", "EyeBrow.L"]
    assert face_bones(others) == others


def test_eyes_and_what_they_look_at_are_known():
    eyes = ["eye.L", "eyes", "LeftEye", "J_Adj_L_FaceEye", "c_eye_target.l", "lEye"]
    others = ["eyelid.L", "eye_master.L", "MCH-eye.L", "eyebrow.R", "EyeSocket", "target"]
    assert eye_bones([*eyes, *others]) == eyes


def test_lids_that_cannot_move_open_by_a_turn_and_eyes_by_any():
    hinge = channels_of("lid.T.L", True, (True,) * 3, False)
    assert [channel.name for channel in hinge] == ["lid.T.L turn x"]
    free = channels_of("lid.T.L", True, (False,) * 3, False)
    assert not any(channel.is_turn for channel in free)
    eye = eye_channels_of("eye.L", False, (False,) * 3, (False, True, False))
    assert [channel.name for channel in eye] == ["eye.L turn x", "eye.L turn z"]
    assert eye[0].range[1] > free[0].range[1]


def test_locked_channels_are_left_out_and_jaws_turn():
    free = channels_of("jaw_master", True, (False, True, False), False)
    assert [channel.name for channel in free] == [
        "jaw_master along x",
        "jaw_master along z",
        "jaw_master turn x",
    ]
    assert [c.name for c in channels_of("jaw", False, (False,) * 3, False)] == ["jaw turn x"]
    assert channels_of("brow.L", False, (False,) * 3, False) == []


def test_a_channel_goes_as_far_as_it_moves_the_mesh_in_proportion():
    response = np.array([[1.0, 0, 0], [0, 0.5, 0]])
    assert reach(-3 * response, response, -3.0, 0.3) == -3
    folded = 3 * response + np.array([[0, 0, 0.2 * 9], [0, 0, 0]])  # as the value's square
    assert reach(folded, response, 3.0, 0.3) == pytest.approx(PROPORTIONAL * np.sqrt(1.25) / 0.2)
    assert reach(50 * folded, response, 3.0, 0.3) == 0.3
    assert reach(folded, 0 * response, 3.0, 0.3) == 3  # moves nothing


@pytest.mark.parametrize(
    ("mode", "path", "expected"),
    [
        ("XYZ", "rotation_euler", [np.radians(20), 0, 0]),
        (
            "QUATERNION",
            "rotation_quaternion",
            [np.cos(np.radians(10)), np.sin(np.radians(10)), 0, 0],
        ),
    ],
)
def test_a_turn_is_ten_degrees_at_value_1(mode, path, expected):
    own_path, rows = turns(np.array([0.0, 2.0]), mode)
    assert own_path == path
    np.testing.assert_allclose(rows[1], expected, atol=1e-12)
