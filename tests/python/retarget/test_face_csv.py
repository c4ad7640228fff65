# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Link Face's table of a performance, written and read back."""

import dataclasses
import itertools

import numpy as np
import pytest
from acting import make_acting
from mimetic import InvalidInput
from mimetic.commands.bake import bake
from mimetic.retarget.face_csv import (
    face_table,
    read_face_csv,
    seconds_of,
    time_code,
    write_face_csv,
)
from mimetic.retarget.unit_fit import unit_order, unit_values

RISE = np.linspace(0, 1, 6)


@pytest.fixture(scope="module")
def acting():
    performance = make_acting({"jaw_open": RISE, "lid_upper.R": RISE[::-1]})
    turn = 0.3
    pose = performance.head_pose.copy()
    # The subject turns the head to their left: x of the head goes away from the camera
    c, s = np.cos(turn), np.sin(turn)
    pose[3, :3, :3] = pose[3, :3, :3] @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return dataclasses.replace(performance, head_pose=pose)


def test_what_is_read_back_is_what_was_written(acting, tmp_path):
    path = tmp_path / "face.csv"
    assert write_face_csv(acting, path) == "6 frames of 61 values"
    table = read_face_csv(path, acting.fps)
    written = face_table(acting)
    assert table.names == written.names
    np.testing.assert_allclose(table.values, written.values, atol=1e-8)
    np.testing.assert_allclose(table.seconds, (acting.frame - 1) / 25.0, atol=1e-4)
    lines = path.read_text().splitlines()
    assert lines[0].startswith("Timecode,BlendShapeCount,EyeBlinkLeft,EyeLookDownLeft,")
    assert lines[0].endswith(",RightEyeYaw,RightEyePitch,RightEyeRoll")
    assert lines[2].startswith("00:00:00:01.000,61,")


def test_units_and_turns_stand_under_their_names(acting):
    table = face_table(acting)
    column = dict(zip(table.names, table.values.T, strict=True))
    units = unit_values(acting)
    for index, unit in enumerate(unit_order()):
        np.testing.assert_array_equal(column[unit[0].upper() + unit[1:]], units[:, index])
    assert column["JawOpen"][-1] > 0.85
    np.testing.assert_allclose(column["EyeBlinkRight"], RISE[::-1], atol=1e-9)
    assert column["HeadYaw"][3] == pytest.approx(0.3)
    assert abs(column["HeadYaw"][2]) < 1e-9
    assert abs(column["HeadPitch"]).max() < 1e-9


@pytest.mark.parametrize(
    ("seconds", "fps", "code"),
    [
        (0.0, 30.0, "00:00:00:00.000"),
        (1 / 30, 30.0, "00:00:00:01.000"),
        (3725.5, 60.0, "01:02:05:30.000"),
        (29 / 29.97, 29.97, "00:00:00:29.000"),
        (30 / 29.97, 29.97, "00:00:01:00.030"),
        (0.99999999999, 25.0, "00:00:01:00.000"),
    ],
)
def test_time_codes(seconds, fps, code):
    assert time_code(seconds, fps) == code
    assert seconds_of(code, fps) == pytest.approx(seconds, abs=1e-3 / fps)


@pytest.mark.parametrize("fps", [23.976, 25.0, 29.97, 59.94])
def test_time_codes_always_go_on(fps):
    codes = [seconds_of(time_code(frame / fps, fps), fps) for frame in range(2000)]
    assert all(b > a for a, b in itertools.pairwise(codes))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "begins with Timecode"),
        ("a,b\n", "begins with Timecode"),
        ("Timecode,BlendShapeCount,A,A\n", "begins with Timecode"),
        ("Timecode,BlendShapeCount,A\n0:0:0:0,1\n", "line 2: 2 values, not 3"),
        ("Timecode,BlendShapeCount,A\n0:0:0,1,1\n", "line 2: '0:0:0' is no time code"),
        ("Timecode,BlendShapeCount,A\n0:0:0:0,1,x\n", "line 2: could not convert"),
        ("Timecode,BlendShapeCount,A\n0:0:0:0,1,nan\n", "line 2: a value is not finite"),
        ("Timecode,BlendShapeCount,A\nnan:0:0:0,1,1\n", "line 2: 'nan:0:0:0' is not a finite"),
        ("Timecode,BlendShapeCount,A\n0:0:inf:0,1,1\n", "line 2: '0:0:inf:0' is not a finite"),
        (f"Timecode,{'B' * 200_000}\n", "line 1: field larger than field limit"),
        (f"Timecode,BlendShapeCount,A\n0:0:0:0,1,{'1' * 200_000}\n", "line 2: field larger"),
    ],
)
def test_what_is_no_table_is_refused(tmp_path, content, message):
    path = tmp_path / "face.csv"
    path.write_text(content)
    with pytest.raises(InvalidInput, match=message):
        read_face_csv(path, 30.0)


def test_the_command_writes_the_table_and_takes_nothing_else(acting, tmp_path):
    path, out = tmp_path / "performance.npz", tmp_path / "face.csv"
    acting.save(path)
    assert bake(path, out) == "6 frames of 61 values"
    assert read_face_csv(out, acting.fps).names == face_table(acting).names
    before = out.read_bytes()
    with pytest.raises(InvalidInput, match="no option but the performance"):
        bake(path, out, with_detail=True)
    assert out.read_bytes() == before
