# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives of arrays made to do harm: each is refused in one line, and takes no memory first."""

import bz2
import io
import lzma
import resource
import struct
import subprocess
import sys
import warnings
import zipfile

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.cli import main
from mimetic.locate import eigenspaces, landmarks
from mimetic.performance.document import Performance
from mimetic.score.truth import Truth
from mimetic.shared.array_file import is_bounded, open_arrays
from mimetic.shared.installed_data import data_folder
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


@pytest.mark.parametrize(("model", "key"), [(eigenspaces, "module_names"), (landmarks, "names")])
def test_names_in_models_are_texts(tmp_path, model, key):
    path = tmp_path / "model.npz"
    with np.load(data_folder() / model.FILE_NAME) as kept:
        arrays = dict(kept)
    arrays[key][0] = "\udcff"
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match=f"{key} holds the name"):
        model.load(path)


@pytest.mark.filterwarnings("error")
def test_landmarks_of_no_size_are_refused_without_a_warning(tmp_path):
    path = tmp_path / "model.npz"
    with np.load(data_folder() / landmarks.FILE_NAME) as kept:
        arrays = dict(kept)
    arrays["outputs"][0, 0, 0] = np.inf
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match="outputs is not finite"):
        landmarks.load(path)


def test_whole_numbers_beyond_those_kept_are_refused_not_wrapped(saved):
    stream = io.BytesIO()
    np.save(stream, np.full(12, 2**63 + 5, np.uint64))
    replace_member(saved, "frame", stream.getvalue())
    with pytest.raises(InvalidInput, match="array frame holds numbers above"):
        Performance.load(saved)


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


@pytest.mark.parametrize("kind", ["f2", "f4", "f8", "i8", "u1", "?"])
def test_numbers_of_every_type_are_held_against_the_limit_without_a_warning(kind):
    """numpy 2 compares in the array's own type, in which the limit may be infinite."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert is_bounded(np.array([0, 1], kind)) and is_bounded(np.array([], kind))
        if kind[0] == "f":
            for number in (np.inf, -np.inf, np.nan):
                assert not is_bounded(np.array([0, number], kind))
        if kind in ("f4", "f8"):
            assert not is_bounded(np.array([2e15], kind))
