# SPDX-License-Identifier: GPL-3.0-or-later
"""Files made to do harm: each is refused in one line, by whatever reader it meets."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.character.landmarks_file import read_landmarks
from mimetic.commands.cli import main
from mimetic.commands.points import read_points
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.media.timing import LAST_SCENE_FRAME, frame_steps, scene_frames, scene_rate
from mimetic.shared.json_file import DEEPEST, parse_json
from mimetic.shared.shown_text import shown
from sample_fit import make_fit
from sample_performance import make_performance

from evaluation.anatomy.mesh_file import read_mesh


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "p.npz"
    make_performance().save(path)
    return path


def test_rates_at_the_ends_can_be_a_scenes():
    for rate in (1e-5, 1 / 3600, 240.0, 1e6):
        result = scene_rate(rate)
        assert 1 <= result.fps <= 32767 and 1e-5 <= result.fps_base <= 1e6
        assert result.fps / result.fps_base == pytest.approx(rate, rel=1e-4)
    for rate in (1e-9, 1e300, np.inf, np.nan, 0.0):
        with pytest.raises(InvalidInput, match="frames a second"):
            scene_rate(rate)


def test_footage_that_falls_off_a_timeline_is_refused_before_it_fills_the_memory():
    with pytest.raises(InvalidInput, match=f"ends at {LAST_SCENE_FRAME}"):
        scene_frames([1, 2000], 1e-5, 24)
    with pytest.raises(InvalidInput, match=f"ends at {LAST_SCENE_FRAME}"):
        frame_steps([1, 2**31 - 1], 24, 25)


@pytest.mark.parametrize("matrix", [np.zeros((3, 3)), -np.eye(3), np.ones((3, 3))])
def test_a_truth_without_a_camera_is_refused(truth, matrix):
    with pytest.raises(InvalidInput, match="truth intrinsics is not a pinhole"):
        replace(truth, intrinsics=matrix)


@pytest.fixture
def fit_json(tmp_path):
    path = tmp_path / "fit.json"
    make_fit().save(path)
    return path, json.loads(path.read_text())


def put(document, keys, value):
    for key in keys[:-1]:
        document = document[key]
    document[keys[-1]] = value


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (["residual"], 10**400, "residual is inf"),
        (["frame"], 10**400, "frame is inf"),
        (["error"], 10**30, "error"),
        (["frame"], 2**31, "from 1 to 2147483647"),
        (["residual"], [[1], [1, 2]], "residual"),
        (["residual"], [[[[1]]]], "residual"),
        (["residual"], 3, "residual must be a list"),
        (["relief"], {"a": 1}, "relief must be a list"),
        (["relief"], ["1", "2"], "relief"),
        (["depth"], {"a": 1}, "depth must be a list"),
        (["lines"], {"a": 1}, "lines must be a list"),
        (["depth"], [[1, 2, 3], [1]], "depth"),
        (["intrinsics"], [["600", 0, 1], [0, 600, 1], [0, 0, 1]], "intrinsics"),
        (["head_pose"], [[1], [2, 3]], "head_pose"),
        (["views", 0, "motion"], [[1, 2, 3, 4], [1]], "motion"),
        (["views", 0, "curves", "jaw"], [[1, 2, 3, 4, [5]]], "curve jaw"),
        (["views", 0, "box"], [1, 2, 3, 10**400], r"views\[0\].box\[3\] is inf"),
        (["identity", "\ud800"], 1.0, "no Unicode"),
        (["calibration", "strength"], {"a": 10**400}, "calibration.strength.a is inf"),
        (["calibration", "frames"], [10**12], "whole numbers from 1"),
    ],
)
def test_a_fits_numbers_are_numbers_of_a_size(fit_json, keys, value, message):
    path, document = fit_json
    put(document, keys, value)
    path.write_text(json.dumps(document))
    with pytest.raises(InvalidInput, match=message):
        FaceFit.load(path)


def test_errors_hold_little_of_what_is_wrong(fit_json):
    path, document = fit_json
    for keys, value in ((["frame"], "n" * 5000), (["n" * 5000], 1), (["schema"], [[0] * 900])):
        changed = dict(document)
        put(changed, keys, value)
        path.write_text(json.dumps(changed))
        with pytest.raises(InvalidInput) as caught:
            FaceFit.load(path)
        assert len(str(caught.value)) < 500 + len(str(path))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"9" * 5000, "is inf"),
        (b"1e999", "is inf"),
        (b"[1, NaN]", r"\[1\] is nan"),
        (b"[" * 100_000, "not JSON"),
        (b"[" * (DEEPEST + 2) + b"]" * (DEEPEST + 2), "nested deeper"),
        (b"[" + b"0," * 3_000_000 + b"0]", "more than 2000000 values"),
        (b'{"a": "\\ud800"}', "a is no Unicode"),
        (b"\xff\xfe", "not UTF-8"),
        (b"", "not JSON"),
    ],
)
def test_json_is_read_within_limits(content, message):
    with pytest.raises(InvalidInput, match=message):
        parse_json(content)


def test_landmarks_of_absurd_numbers_are_refused(tmp_path):
    path = tmp_path / "l.json"
    for text in (
        '{"chin": ' + "9" * 400 + "}",
        '{"chin": ' + "9" * 5000 + "}",
        '{"chin": [1, 2, 1e999]}',
    ):
        path.write_text(text)
        with pytest.raises(InvalidInput, match="chin"):
            read_landmarks(path)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\n{}element face 1\n{}end_header\n{}"
XYZ = "property float x\nproperty float y\nproperty float z\n"
LIST = "property list uchar int vertex_indices\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        (
            "a.ply",
            PLY.format(XYZ, LIST, "0 0 0\n1 0 0\n0 1 0\n3 0 1 1e30\n"),
            "face 0 cannot be read",
        ),
        (
            "g.ply",
            PLY.format(XYZ, LIST, "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1e30\n"),
            "face 0 cannot be read",
        ),
        ("b.ply", PLY.format(XYZ, LIST, "0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n"), "not finite"),
        ("c.ply", PLY.format(XYZ + "property float x\n", LIST, ""), "names of their own"),
        (
            "d.ply",
            PLY.format("", LIST, "").replace("ascii", "binary_little_endian"),
            "1 to 64 properties",
        ),
        (
            "e.ply",
            PLY.format(XYZ, LIST.replace("int", "float"), "0 0 0\n" * 3 + "3 0 1 2\n"),
            "no list",
        ),
        (
            "f.ply",
            PLY.format(LIST.replace("vertex_indices", "x") + XYZ[17:], LIST, "1 0 0 0\n" * 3),
            "no x",
        ),
        ("a.obj", "v 0 0 nan\nf 1 1 1\n", "line 1"),
        ("b.obj", "v 0 0 0\nf 1 1 2\n", "does not have"),
        ("c.obj", "v 0 0 0\nf 1 1 " + "9" * 5000 + "\n", "does not have"),
        ("d.obj", "v" + " 0" * 40_000, "longer than"),
        ("a.gltf", '{"nodes": [{"mesh": 0, "scale": [' + "9" * 400 + ", 1, 1]}]}", "is inf"),
    ],
)
def test_meshes_of_absurd_numbers_are_refused(tmp_path, name, content, message):
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(InvalidInput, match=message):
        read_mesh(path)


def test_faces_whose_number_of_corners_keeps_changing_are_read(tmp_path):
    """Each change once looked at all faces that were left: hours for a file of a megabyte."""
    faces = 60_000
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex 4\n{XYZ}element face {faces}\n"
    both = struct.pack("<B3i", 3, 0, 1, 2) + struct.pack("<B4i", 4, 0, 1, 2, 3)
    path = tmp_path / "mixed.ply"
    path.write_bytes((head + LIST + "end_header\n").encode() + bytes(48) + both * (faces // 2))
    _, read = read_mesh(path)
    assert len(read) == faces and (read[1::2, 3] == 3).all() and (read[::2, 3] == -1).all()


@pytest.mark.parametrize("row", ["1e300,5", "nan,1", "9" * 200_000 + ",1", "\x00,1", "1,2,3"])
def test_points_that_no_picture_has_are_refused_in_a_short_line(tmp_path, row):
    path = tmp_path / "p.csv"
    path.write_text(f"x,y\n{row}\n")
    with pytest.raises(InvalidInput) as caught:
        read_points(path)
    assert len(str(caught.value)) < 300 + len(str(path))


@pytest.mark.parametrize(
    "name",
    [
        *("n" * 300, "n" * 300 + "_01.png", "#" * 300 + ".png", "n" * 300 + "%09d.png"),
        *("%0999999d.png", "a\0b", "a\0_01.png", "-i", "http://127.0.0.1/a.mp4", "concat:a|b"),
        "\udcff",
    ],
)
def test_names_of_footage_are_names_of_files_alone(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UnreadableMedia):
        Footage(name)


def test_what_a_file_says_cannot_steer_the_terminal(saved, tmp_path, capsys):
    note = "ends early\x1b]0;owned\x07\x9b2J \u202egpj.exe\u2066 \udcff\nnote: all is well"
    make_performance(notes=[note]).save(saved)
    assert main(["info", str(saved)]) == 0
    text = capsys.readouterr().out
    assert "ends early\\x1b]0;owned\\x07\\x9b2J \\u202egpj.exe\\u2066 \\udcff\\nnote" in text
    assert not set("\x1b\x07\x9b\u202e\u2066\udcff") & set(text)
    path = tmp_path / "fit.json"
    make_fit().save(path)
    document = json.loads(path.read_text()) | {"\x1b[2J\u202e\x9b5m": 1}
    path.write_text(json.dumps(document))
    with pytest.raises(InvalidInput) as caught:
        FaceFit.load(path)
    assert not set("\x1b\x9b\u202e") & set(str(caught.value))  # Blender shows it, too
    hostile = tmp_path / "\x1b[31m.npz"
    hostile.write_bytes(str(caught.value).encode())
    assert main(["info", str(hostile)]) == 2
    assert "\x1b" not in capsys.readouterr().err


def test_shown_text_keeps_what_people_write():
    for text in ("Größe 90°", "日本語", "naïve “quoted”", "screenshot\u202f10.mp4", "👩\u200d🎤"):
        assert shown(text) == text
