# SPDX-License-Identifier: GPL-3.0-or-later
"""Files made to do harm: each is refused in one line, with no memory or time worth mentioning."""

import bz2
import io
import json
import lzma
import resource
import struct
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, eigenspaces, landmarks
from mimetic.array_file import open_arrays
from mimetic.cli import main
from mimetic.evaluate.truth import Truth
from mimetic.face_fit import FaceFit
from mimetic.face_template import data_folder
from mimetic.footage import Footage
from mimetic.json_file import DEEPEST, parse_json
from mimetic.mesh_file import read_landmarks, read_mesh
from mimetic.performance import Performance
from mimetic.points import read_points
from mimetic.shown_text import shown
from mimetic.timing import LAST_SCENE_FRAME, frame_steps, scene_frames, scene_rate
from sample_fit import make_fit
from sample_performance import make_performance


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "p.npz"
    make_performance().save(path)
    return path


def npy(header: str, numbers: bytes = b"") -> bytes:
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + numbers


def replace_member(path, name, content, compression=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(path) as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    with zipfile.ZipFile(path, "w", compression) as archive:
        for member, kept in (members | {f"{name}.npy": content}).items():
            archive.writestr(member, kept)


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), ",
        "{",
        "{b'descr': '<f8', b'fortran_order': False, b'shape': (1,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (True,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1.0,), }",
        "{'descr': '<f8', 'fortran_order': 1, 'shape': (1,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (" + "9" * 400 + ",), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (" + "9" * 5000 + ",), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': " + "(" * 3000 + ", }",
        "{'descr': '<U0', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '<V8', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '|S99999999999', 'fortran_order': False, 'shape': (1,), }",
        "[1, 2]",
        "",
    ],
)
def test_headers_of_arrays_are_read_as_numpy_writes_them_or_refused(saved, capsys, header):
    replace_member(saved, "fps", npy(header, struct.pack("<d", 25)))
    assert main(["info", str(saved)]) == 2
    error = capsys.readouterr().err
    assert "array fps" in error and error.count("\n") == 1 and "Traceback" not in error


def test_headers_in_another_order_and_with_other_quotes_are_read(saved):
    header = '{"shape": (1,), "descr": ">f4", "fortran_order": False}'
    replace_member(saved, "fps", npy(header, struct.pack(">f", 25)))
    assert Performance.load(saved).fps == 25


def test_arrays_in_fortran_order_and_in_the_other_byte_order_are_read(saved, tmp_path):
    before = Performance.load(saved)
    stream = io.BytesIO()
    np.save(stream, np.asfortranarray(before.head_pose.astype(">f8")))
    replace_member(saved, "head_pose", stream.getvalue())
    np.testing.assert_array_equal(Performance.load(saved).head_pose, before.head_pose)


@pytest.mark.parametrize(
    ("compression", "compress"),
    [(zipfile.ZIP_LZMA, lzma.compress), (zipfile.ZIP_BZIP2, bz2.compress)],
)
@pytest.mark.parametrize("damaged", [False, True])
def test_other_compressions_are_refused_by_all_readers(
    saved, tmp_path, capsys, compression, compress, damaged
):
    replace_member(saved, "quality", b"", compression)
    content = saved.read_bytes()
    if damaged:
        middle = len(content) // 2
        saved.write_bytes(content[:middle] + bytes(400) + content[middle + 400 :])
    assert main(["info", str(saved)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    for read in (Truth.load, Performance.load):
        with pytest.raises((InvalidInput, UnreadableMedia), match=r"p\.npz"):
            read(saved)


def test_characters_that_there_are_not_are_refused(saved):
    codes = np.full((36, 8), 0x110000, "<u4")
    stream = io.BytesIO()
    np.save(stream, codes.view("<U8").reshape(36))
    replace_member(saved, "muscles", stream.getvalue())
    with pytest.raises(InvalidInput, match="array muscles holds characters that there are not"):
        Performance.load(saved)


@pytest.mark.parametrize("name", ["", "a\nb", "\x1b[2J", "\u202egpj.exe", "\udcff", "n" * 61])
def test_names_that_cannot_be_shown_or_looked_up_are_refused(name):
    with pytest.raises(InvalidInput, match="can be printed"):
        make_performance(articulators=["jaw_open", name])


def test_a_muscle_and_an_articulator_of_one_name_are_refused():
    with pytest.raises(InvalidInput, match="distinct"):
        make_performance(articulators=["jaw_open", "muscle_00.L"])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frame": np.arange(12) + 2**31}, "beyond 2147483647"),
        ({"frame": np.array([1, 2**63 - 1] + [-(2**63)] * 10)}, "count upwards"),
        ({"fps": 1e-9}, "fps is 1e-09"),
        ({"fps": 1e300}, "fps is "),
        ({"fps": np.inf}, "fps is "),
        ({"neutral_vertices": np.full((81, 3), 1e300)}, "neutral_vertices is not finite, or"),
        ({"head_pose_cov": np.tile(np.ones((6, 6)) - np.eye(6), (12, 1, 1))}, "not a covariance"),
    ],
)
def test_numbers_that_no_footage_has_are_refused(changes, message):
    with pytest.raises(InvalidInput, match=message):
        make_performance(**changes)


@pytest.mark.filterwarnings("error")
def test_a_signalling_nan_is_refused_without_a_warning(tmp_path):
    path = tmp_path / "model.npz"
    with np.load(data_folder() / eigenspaces.FILE_NAME) as kept:
        arrays = dict(kept)
    arrays["other_basis"].view(np.uint32)[0, 0] = 0x7F800001
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match=r"model\.npz"):
        eigenspaces.load(path)


@pytest.mark.parametrize(("key", "value"), [("view_0_size", 2**40), ("module_1_size", -1)])
def test_windows_that_cannot_be_are_refused(tmp_path, key, value):
    path = tmp_path / "model.npz"
    with np.load(data_folder() / eigenspaces.FILE_NAME) as kept:
        np.savez(path, **(dict(kept) | {key: np.array([24, value])}))
    with pytest.raises(InvalidInput, match=f"{key} is"):
        eigenspaces.load(path)


@pytest.mark.filterwarnings("error")
def test_landmarks_of_no_size_are_refused_without_a_warning(tmp_path):
    path = tmp_path / "model.npz"
    with np.load(data_folder() / landmarks.FILE_NAME) as kept:
        arrays = dict(kept)
    arrays["outputs"][0, 0, 0] = np.inf
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match="outputs is not finite"):
        landmarks.load(path)


def test_errors_hold_little_of_what_is_wrong(fit_json):
    path, document = fit_json
    for keys, value in ((["frame"], "n" * 5000), (["n" * 5000], 1), (["schema"], [[0] * 900])):
        changed = dict(document)
        put(changed, keys, value)
        path.write_text(json.dumps(changed))
        with pytest.raises(InvalidInput) as caught:
            FaceFit.load(path)
        assert len(str(caught.value)) < 500 + len(str(path))


def test_whole_numbers_beyond_those_kept_are_refused_not_wrapped(saved):
    stream = io.BytesIO()
    np.save(stream, np.full(12, 2**63 + 5, np.uint64))
    replace_member(saved, "frame", stream.getvalue())
    with pytest.raises(InvalidInput, match="array frame holds numbers above"):
        Performance.load(saved)


def test_rates_at_the_ends_can_be_a_scenes():
    for rate in (1e-5, 1 / 3600, 240.0, 1e6):
        made = scene_rate(rate)
        assert 1 <= made.fps <= 32767 and 1e-5 <= made.fps_base <= 1e6
        assert made.fps / made.fps_base == pytest.approx(rate, rel=1e-4)
    for rate in (1e-9, 1e300, np.inf, np.nan, 0.0):
        with pytest.raises(InvalidInput, match="frames a second"):
            scene_rate(rate)


def test_footage_that_falls_off_a_timeline_is_refused_before_it_fills_the_memory():
    with pytest.raises(InvalidInput, match=f"ends at {LAST_SCENE_FRAME}"):
        scene_frames([1, 2000], 1e-5, 24)
    with pytest.raises(InvalidInput, match=f"ends at {LAST_SCENE_FRAME}"):
        frame_steps([1, 2**31 - 1], 24, 25)


CLAIM = """
import resource, sys
import numpy as np
from mimetic import InvalidInput
from mimetic.performance import Performance
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    Performance.load(sys.argv[1])
except InvalidInput as error:
    print(error)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024)
"""


def test_small_numbers_are_counted_as_they_are_kept_before_memory_is_set_aside(saved):
    """280 MB of int8 that deflate to 1.3 MB, and would be kept as 2.3 GB of float64."""
    n = 250_000
    shapes = {"frame": (n,), "head_pose": (n, 4, 4), "head_pose_cov": (n, 6, 6), "quality": (n,)}
    shapes |= {"activations": (n, 36), "activations_std": (n, 36), "articulators": (1000,)}
    shapes |= {"articulator_values": (n, 1000), "articulator_modes": (1000, 81, 3)}
    with zipfile.ZipFile(saved) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(saved, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for member, kept in members.items():
            name = member.removesuffix(".npy")
            if name in shapes:
                dtype = np.dtype("<U1" if name == "articulators" else "i1")
                header = f"{{'descr': {dtype.str!r}, 'fortran_order': False, "
                header += f"'shape': {shapes[name]!r}, }}"
                kept = npy(header, bytes(int(np.prod(shapes[name])) * dtype.itemsize))
            archive.writestr(member, kept)
    assert saved.stat().st_size < 3_000_000
    ran = subprocess.run([sys.executable, "-c", CLAIM, saved], capture_output=True, text=True)
    error, grown = ran.stdout.splitlines()
    assert "bytes of arrays as they are kept" in error
    assert int(grown) < 50, "megabytes"


def test_an_archives_list_of_contents_cannot_fill_the_memory(tmp_path):
    """A central directory of 50 MB: a million names of arrays."""
    entry = struct.pack("<4s6H3L5H2L", b"PK\1\2", 20, 20, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0)
    listed = (entry + b"a.npy") * 1_000_000
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 65535, 65535, len(listed), 0, 0)
    path = tmp_path / "many.npz"
    path.write_bytes(listed + end)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(UnreadableMedia, match="list of contents is too long"), open_arrays(path):
        pass
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 30_000


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
    "name", ["n" * 300, "a\0b", "-i", "http://127.0.0.1/a.mp4", "concat:a|b", "\udcff"]
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
    path.write_text('{"schema": "\\u001b[2J\\u202e", "\\u009b5m": 1}')
    with pytest.raises(InvalidInput) as caught:
        FaceFit.load(path)
    hostile = tmp_path / "\x1b[31m.npz"
    hostile.write_bytes(str(caught.value).encode())
    assert main(["info", str(hostile)]) == 2
    assert "\x1b" not in capsys.readouterr().err


def test_shown_text_keeps_what_people_write():
    for text in ("Größe 90°", "日本語", "naïve “quoted”", "screenshot\u202f10.mp4", "👩\u200d🎤"):
        assert shown(text) == text
