# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that characters' controls are known by."""

import re

import numpy as np
import pytest
from mimetic.retarget.control_names import (
    conventions,
    known_names,
    mirrored_name,
    side_of,
    unit_shares,
)
from mimetic.template.face_template import load_template


def test_every_name_of_the_tables_means_units_that_there_are():
    units = set(load_template().unit_names)
    for convention in conventions():
        assert convention.controls, convention.name
        for known in convention.controls.values():
            assert set(known.units) <= units, known


@pytest.mark.parametrize(
    "spell",
    [
        str,
        lambda unit: unit.replace("Left", "_L").replace("Right", "_R"),
        lambda unit: unit[0].upper() + unit[1:],
        lambda unit: f"blendShape1.{unit}",
        lambda unit: unit.replace("Left", ".L").replace("Right", ".R"),
    ],
)
def test_all_52_of_arkit_are_known_in_every_spelling(spell):
    units = load_template().unit_names
    names = [spell(unit) for unit in units]
    np.testing.assert_array_equal(unit_shares(names, known_names(names)), np.eye(52))


@pytest.mark.parametrize(
    ("name", "units"),
    [
        ("blink", {"eyeBlinkLeft": 0.5, "eyeBlinkRight": 0.5}),
        ("blinkRight", {"eyeBlinkRight": 1}),
        ("EyeClosedLeft", {"eyeBlinkLeft": 1}),
        ("MouthCornerPullRight", {"mouthSmileRight": 0.8}),
        ("CTRL_expressions_eyeLookLeftR", {"eyeLookInRight": 1}),
        ("CTRL_expressions_mouthCornerPullL", {"mouthSmileLeft": 1}),
        ("happy", {}),
        ("Blink_L", {"eyeBlinkLeft": 1}),
        ("Joy", {}),
        ("Fcl_EYE_Close_L", {"eyeBlinkLeft": 1}),
        ("Face.M_F00_000_00_Fcl_EYE_Close_R", {"eyeBlinkRight": 1}),
        ("Face_Blendshape.Fcl_MTH_A", {"jawOpen": 1.4}),
        ("Fcl_ALL_Sorrow", {}),
    ],
)
def test_names_of_other_conventions(name, units):
    assert known_names([name])[name].units == units


def test_a_shared_name_is_read_by_the_convention_that_most_names_are_of():
    # Two conventions have "mouthLeft"; "EyeClosed" is of one alone
    names = ["MouthStretchLeft", "EyeClosedLeft", "LipFunnelUpperLeft", "MouthPressLeft"]
    assert {known.convention for known in known_names(names).values()} == {"Unified Expressions"}


def test_a_vowels_letter_is_one_where_all_five_are():
    assert known_names(["A", "O", "Blink_L"]).keys() == {"Blink_L"}
    known = known_names([*"AIUEO", "Blink_L", "Sorrow"])
    assert known["A"].units == {"jawOpen": 1.4}
    assert {one.convention for one in known.values()} == {"VRM 0"}


def test_bones_of_rigifys_faces_are_known_by_their_channels_alone():
    legacy = ["brow.T.L.001 along z", "eyes along x", "jaw_master turn x", "tail along x"]
    known = known_names(legacy)
    assert {name: one.convention for name, one in known.items()} == dict.fromkeys(
        legacy[:3], "Rigify's legacy face"
    )
    assert not unit_shares(legacy, known).any()
    new = [*legacy[::2], "lip_end.L.001 along x", "jaw_master_mouth along y"]
    assert {one.convention for one in known_names(new).values()} == {"Rigify's new face"}
    assert known_names(["eyes", "nose", "Jaw"]) == {}
    assert known_names(["jaw turn x", "Brow_L along x", "Lip_L along x"]) == {}  # another rig


def test_strange_names_are_unknown():
    assert known_names(["Key 1", "Fat", "", ".", "L", "smile_special"]) == {}


@pytest.mark.parametrize(
    ("name", "twin"),
    [
        ("eyeBlinkLeft", "eyeBlinkRight"),
        ("eyeBlink_R", "eyeBlink_L"),
        ("brow.T.L.001", "brow.T.R.001"),
        ("brow.L along z", "brow.R along z"),
        ("c_lips_smile.l turn x", "c_lips_smile.r turn x"),
        ("mouthCornerPullL", "mouthCornerPullR"),
        ("LeftBlink", "RightBlink"),
        ("CTRL_expressions_mouthFunnelUL", "CTRL_expressions_mouthFunnelUR"),
        ("CTRL_expressions_mouthLipsTogetherDL", "CTRL_expressions_mouthLipsTogetherDR"),
        ("CTRL_expressions_jawChinRaiseUL", "CTRL_expressions_jawChinRaiseUR"),
        ("CTRL_expressions_eyeLookLeftL", "CTRL_expressions_eyeLookRightR"),
        ("CTRL_expressions_eyeLookRightL", "CTRL_expressions_eyeLookLeftR"),
        ("eye_look_left_L", "eye_look_right_R"),
        ("eyeLookUpL", "eyeLookUpR"),
        ("eyeLookLeft", "eyeLookRight"),
        ("jawOpen", "jawOpen"),
        ("ALL", "ALL"),
        ("L", "L"),
    ],
)
def test_mirrored_names(name, twin):
    assert mirrored_name(name) == twin
    assert mirrored_name(twin) == name


@pytest.mark.parametrize("side", ["L", "R"])
def test_a_mirrored_name_means_the_mirror_image(side):
    sides = {"Left": "Right", "Right": "Left"}
    names = [f"CTRL_expressions_eyeLook{way}{side}" for way in ("Left", "Right", "Up", "Down")]
    names += [f"CTRL_expressions_mouthFunnel{lip}{side}" for lip in "UD"]
    for name in names:
        twin = mirrored_name(name)
        assert side_of(name) == side != side_of(twin)
        meaning = known_names([name, twin])
        expected = {
            re.sub("Left|Right", lambda word: sides[word.group()], unit): share
            for unit, share in meaning[name].units.items()
        }
        assert meaning[twin].units == expected


def test_arkits_shapes_are_found_in_any_spelling_and_shares_are_none():
    from mimetic.retarget.control_names import units_of

    names = ["jaw_open", "eyeBlink_L", "eyeBlinkLeft", "fat", "mouthSmile_R"]
    assert units_of(names) == {
        "eyeBlinkLeft": "eyeBlinkLeft",
        "jawOpen": "jaw_open",
        "mouthSmileRight": "mouthSmile_R",
    }
    assert units_of(["aa", "happy"]) == {}  # VRM's, which are several at once
