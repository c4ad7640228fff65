# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of how a character's controls are driven, and its presets."""

import dataclasses
import json

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.retarget.controls import (
    ControlRow,
    load_preset,
    mirrored,
    refitted,
    save_preset,
    waiting,
)

EDITED = ControlRow("eyeBlinkLeft", True, 1.3, -0.1, 0.0, 0.9, is_edited=True)
RISE = np.linspace(0, 1, 5)
ROWS = [EDITED, ControlRow("eyeBlinkRight"), ControlRow("jawOpen")]


def test_a_row_scales_shifts_and_cuts():
    values = EDITED.played(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(values, [0.0, 0.55, 0.9])


def test_a_row_bends_small_motions_and_leaves_full_ones():
    row = dataclasses.replace(ROWS[1], curve=2.0)
    np.testing.assert_allclose(row.played(np.array([0.0, 0.5, 1.0])), [0.0, 0.25, 1.0])


def test_a_curve_of_a_preset_has_limits(tmp_path):
    path = tmp_path / "hero.json"
    save_preset([dataclasses.replace(ROWS[1], curve=2.5)], path)
    assert load_preset(path)[0].curve == 2.5
    path.write_text(path.read_text().replace("2.5", "0.0"))
    with pytest.raises(InvalidInput, match=r"eyeBlinkRight\): its curve is 0; it lies from 0.1"):
        load_preset(path)


def test_a_range_turned_over_is_refused_by_its_name(tmp_path):
    wrong = dataclasses.replace(ROWS[1], lowest=0.8, highest=0.2)
    for refused in (lambda: wrong.played(RISE), lambda: save_preset([wrong], tmp_path / "a.json")):
        with pytest.raises(InvalidInput, match=r"eyeBlinkRight\): its range is from 0.8 to 0.2"):
            refused()
    assert not list(tmp_path.iterdir())


def test_edited_rows_survive_a_refit_and_others_follow_the_character():
    ranges = {"jawOpen": (0, 1.5), "eyeBlinkLeft": (0, 1), "new": (-1, 1)}
    rows = refitted([dataclasses.replace(ROWS[2], gain=5), EDITED], ranges)
    assert rows == [
        ControlRow("jawOpen", highest=1.5),
        EDITED,
        ControlRow("new", lowest=-1.0),
    ]


def test_edited_rows_of_controls_that_are_gone_wait():
    ranges = {"jawOpen": (0, 1.5)}
    gone = dataclasses.replace(ROWS[2], gain=5)
    assert not gone.is_edited
    assert waiting([gone, EDITED], ranges) == [EDITED]
    assert waiting([EDITED], {EDITED.control: (0, 1)}) == []


def test_edits_of_one_side_are_given_to_the_other():
    rows = mirrored(ROWS)
    assert rows[1] == dataclasses.replace(EDITED, control="eyeBlinkRight")
    assert [rows[0], rows[2]] == [EDITED, ROWS[2]]
    assert mirrored(ROWS, "R") == ROWS  # nothing of that side was edited
    with pytest.raises(InvalidInput, match="side 'X'"):
        mirrored(ROWS, "X")


@pytest.mark.parametrize(
    ("channel", "is_turned_over"),
    [
        *(("along x", True), ("along y", False), ("along z", False)),
        *(("turn x", False), ("turn y", True), ("turn z", True)),
    ],
)
def test_a_bones_channel_does_the_mirror_image_on_the_other_side(channel, is_turned_over):
    row = ControlRow(f"lip.T.L.001 {channel}", offset=0.5, highest=2.0, is_edited=True)
    twin = ControlRow(f"lip.T.R.001 {channel}", lowest=-3.0, highest=3.0)
    expected = (-0.5, -2.0, 0.0) if is_turned_over else (0.5, 0.0, 2.0)
    _, given = mirrored([row, twin])
    assert (given.offset, given.lowest, given.highest) == expected
    assert mirrored([twin, given], "R")[1] == given


def test_a_preset_is_read_as_it_was_written(tmp_path):
    save_preset(ROWS, tmp_path / "face.json")
    assert load_preset(tmp_path / "face.json") == ROWS


def damaged(change) -> bytes:
    document = {
        "format": "mimetic controls 1",
        "controls": [dataclasses.asdict(row) for row in ROWS],
    }
    change(document)
    return json.dumps(document).encode()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[]", "not a preset of controls"),
        (b"{", "not a preset of controls"),
        (damaged(lambda d: d.update(format="other")), '"format" is not'),
        (damaged(lambda d: d.update(controls={})), 'has a list "controls"'),
        (damaged(lambda d: d["controls"].append(3)), "control 4 has no name"),
        (damaged(lambda d: d["controls"][0].update(gain="much")), "control 1: gain is 'much'"),
        (damaged(lambda d: d["controls"][0].update(is_on=1)), "control 1: is_on is 1"),
        (damaged(lambda d: d["controls"][1].update(gain=1e9)), "within 1000"),
        (damaged(lambda d: d["controls"][1].update(lowest=2)), "range is from 2 to 1"),
        (damaged(lambda d: d["controls"][1].update(wave=2)), "unknown 'wave'"),
        (damaged(lambda d: d["controls"].append(d["controls"][0])), "named twice"),
    ],
)
def test_damaged_presets_are_refused_in_one_line(tmp_path, content, message):
    path = tmp_path / "face.json"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=message) as error:
        load_preset(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)
