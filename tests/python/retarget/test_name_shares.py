# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls of one mesh that mean the same play each face unit once."""

import dataclasses

import numpy as np
import pytest
from acting import make_acting
from mimetic.retarget.control_names import known_names, unit_shares
from mimetic.retarget.controls import ControlRow
from mimetic.retarget.name_shares import shares_once
from mimetic.retarget.playing import play, remarks
from mimetic.template.face_template import load_template
from surfaces import make_surface

ARKIT = list(load_template().unit_names)
VROID = ["Fcl_EYE_Close", "Fcl_EYE_Close_L", "Fcl_EYE_Close_R", "Fcl_MTH_A"]


def resting(names, is_shared=None) -> set[str]:
    """Of controls with known names those that play nothing."""
    known, everywhere = known_names(names), np.ones(len(names), dtype=bool)
    shares = shares_once(names, known, everywhere if is_shared is None else np.array(is_shared))
    is_named = unit_shares(names, known).any(axis=1)
    return {names[k] for k in np.flatnonzero(is_named & ~shares.any(axis=1))}


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (VROID, {"Fcl_EYE_Close"}),
        (["blink", "blinkLeft", "blinkRight", "aa"], {"blink"}),
        ([*VROID, *ARKIT], set(VROID)),
        (["blink", "jawOpen"], set()),
        (["eyeBlink_L", "eyeBlinkLeft", "JawOpen", "jaw_open"], {"eyeBlink_L", "jaw_open"}),
        (ARKIT, set()),
    ],
)
def test_what_others_play_rests(names, expected):
    assert resting(names) == expected


@pytest.mark.parametrize("name", ["Unified Expressions", "MetaHuman"])
def test_parts_of_a_unit_all_play(name):
    parts = {
        "Unified Expressions": ["LipFunnelUpperLeft", "LipFunnelLowerRight", "BrowPinchLeft"],
        "MetaHuman": ["CTRL_expressions_browDownL", "CTRL_expressions_browLateralL"],
    }[name]
    parts += ["BrowLowererLeft"] if name != "MetaHuman" else []
    assert resting(parts) == set()


def test_a_part_that_another_convention_plays_whole_rests():
    assert resting(["LipFunnelUpperLeft", "mouthFunnel"]) == {"LipFunnelUpperLeft"}


def test_one_eye_of_two_is_left_to_its_own_control():
    names = ["blink", "blinkLeft"]
    shares = shares_once(names, known_names(names), np.ones(2, dtype=bool))
    left, right = (ARKIT.index(f"eyeBlink{side}") for side in ("Left", "Right"))
    np.testing.assert_array_equal(shares[:, [left, right]], [[0, 0.5], [1, 0]])


def test_controls_of_other_meshes_play_too():
    names = ["head.jawOpen", "teeth.jawOpen", "tongue.jawOpen"]
    assert resting(names, [True, False, False]) == set()
    assert resting(names) == set(names[1:])


def test_a_blink_of_both_eyes_rests_beside_one_of_each_and_says_why():
    acting = make_acting({"lid_upper.L": [0.0, 1.0], "lid_upper.R": [0.0, 1.0]})
    surface = make_surface(has_muscles=False)
    blinks = [surface.control_names.index(f"eyeBlink{side}") for side in ("Left", "Right")]
    controls = surface.controls[blinks]
    surface = dataclasses.replace(
        surface,
        control_names=["Fcl_EYE_Close_L", "Fcl_EYE_Close_R", "Fcl_EYE_Close"],
        controls=np.stack([*controls, controls.sum(axis=0)]),
        control_range=np.tile([0.0, 1.0], (3, 1)),
    )
    played = play(acting, surface)
    assert played.resting == played.doubles == ["Fcl_EYE_Close"]
    rows = [ControlRow(name) for name in surface.control_names]
    assert "others play what it means" in remarks(rows, played)["Fcl_EYE_Close"]
    alone = play(acting, surface, rows[2:])
    assert alone.names == ["Fcl_EYE_Close"]
    np.testing.assert_allclose(alone.values[:, 0], played.values[:, :2].mean(axis=1))
    assert alone.values.max() > 0.5
