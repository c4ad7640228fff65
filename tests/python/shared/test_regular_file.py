# SPDX-License-Identifier: GPL-3.0-or-later
"""Only regular files are read and replaced, and what is none is told before the work."""

import os
import signal
import socket
import stat
import tempfile
from pathlib import Path

import pytest
from clips import make_clip
from mimetic import InvalidInput, UnreadableMedia
from mimetic.character.landmarks_file import read_landmarks
from mimetic.commands.cli import main
from mimetic.commands.points import read_points
from mimetic.fit.face_fit import FaceFit
from mimetic.locate.eigenspaces import load
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.score.truth import Truth
from mimetic.shared.array_file import read_archive
from mimetic.shared.regular_file import check_target
from mimetic.shared.whole_file import whole_file
from sample_performance import make_performance

from evaluation.anatomy.mesh_file import read_mesh

READERS = {
    "footage": Footage,
    "performance": Performance.load,
    "fit": FaceFit.load,
    "points": read_points,
    "truth": Truth.load,
    "eigenspaces": load,
    "landmarks": read_landmarks,
    "archive": lambda path: read_archive(path, {}, {}, {}),
    "mesh": lambda path: read_mesh(path.with_suffix(".obj")),
}


@pytest.fixture(autouse=True)
def no_waiting():
    """A pipe that is opened is waited for forever: that is a failure, too."""

    def give_up(*_):
        raise AssertionError("it waits for a pipe")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def make(kind, path):
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "link to a pipe":
        os.mkfifo(path.with_name("the_pipe"))
        path.symlink_to("the_pipe")
    elif kind == "link to a device":
        path.symlink_to("/dev/zero")
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as result:
            here = os.open(path.parent, os.O_RDONLY)  # a socket's whole path has 107 bytes at most
            result.bind(f"/proc/self/fd/{here}/{path.name}")
            os.close(here)
    elif kind == "folder":
        path.mkdir()
    elif kind == "device":
        try:
            os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 3))
        except PermissionError:
            pytest.skip("devices are made by the superuser")


@pytest.mark.parametrize("kind", ["pipe", "link to a device", "folder"])
@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_regular_file_is_no_input(tmp_path, reader, kind):
    path = tmp_path / "input.obj"
    make(kind, path)
    word = {"pipe": "is a named pipe", "link to a device": "is a device"}.get(kind, "is a folder")
    with pytest.raises(UnreadableMedia, match=rf"input\.obj {word}, not a file(;|, and).* give "):
        READERS[reader](path)


KINDS = ["pipe", "link to a pipe", "socket", "folder", "device"]


@pytest.mark.parametrize("kind", KINDS)
def test_only_regular_files_are_replaced(tmp_path, kind):
    path = tmp_path / "out.npz"
    make(kind, path)
    before = os.stat(path)
    for write in (check_target, lambda path: whole_file(path).__enter__()):
        with pytest.raises(UnreadableMedia, match=r"out\.npz is a .*; give the name of a file"):
            write(path)
    assert os.stat(path).st_mode == before.st_mode and os.stat(path).st_ino == before.st_ino
    assert {name.name for name in tmp_path.iterdir()} <= {"out.npz", "the_pipe"}


def points_command(tmp_path, out):
    make_performance().save(tmp_path / "p.npz")
    (tmp_path / "at.csv").write_text("x,y\n150,100\n")
    words = ("points", tmp_path / "p.npz", "--at", tmp_path / "at.csv", "--out", out)
    return main([str(word) for word in words])


@pytest.mark.parametrize("kind", ["pipe", "link to a pipe", "folder", "device"])
def test_points_refuses_such_a_target_in_one_line(tmp_path, kind, capsys):
    make(kind, tmp_path / "out.npz")
    before = os.stat(tmp_path / "out.npz").st_ino
    assert points_command(tmp_path, tmp_path / "out.npz") == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "out.npz is a" in error
    assert os.stat(tmp_path / "out.npz").st_ino == before


def test_a_missing_folder_is_told_before_the_work(tmp_path, capsys):
    assert points_command(tmp_path, tmp_path / "absent" / "t.npz") == 2
    assert "there is no folder" in capsys.readouterr().err
    make_clip(tmp_path / "c.mp4")
    words = ("calibrate", tmp_path / "c.mp4", "--out", tmp_path / "absent" / "fit.json")
    assert main([str(word) for word in words]) == 2
    assert "there is no folder" in capsys.readouterr().err


@pytest.mark.parametrize("what", ["fit", "head", "locate"])
def test_evaluate_tells_of_its_folder_before_the_work(tmp_path, capsys, what):
    (tmp_path / "file").touch()
    assert main(["evaluate", what, "--out", str(tmp_path / "file")]) == 2
    assert "is a file; give a folder" in capsys.readouterr().err


def test_a_file_that_is_read_only_stays(tmp_path, capsys):
    out = tmp_path / "t.npz"
    out.write_bytes(b"kept")
    out.chmod(0o444)
    assert points_command(tmp_path, out) == 2
    assert "read-only" in capsys.readouterr().err
    assert out.read_bytes() == b"kept"


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o555)
    user = os.geteuid()
    if user == 0:
        folder = tmp_path
        while folder.name != Path(tempfile.gettempdir()).name:  # pytest's own, closed to others
            folder.chmod(0o755)
            folder = folder.parent
        os.seteuid(65534)
    try:
        with pytest.raises(UnreadableMedia, match="folder that can be written to"):
            check_target(closed / "t.npz")
    finally:
        os.seteuid(user)


def test_what_is_read_is_not_replaced(tmp_path, capsys):
    assert points_command(tmp_path, tmp_path / "p.npz") == 2
    assert "what is read" in capsys.readouterr().err
    assert Performance.load(tmp_path / "p.npz").num_frames == 12
    with pytest.raises(InvalidInput, match="what is read"):
        check_target(tmp_path / "p.npz", tmp_path / "at.csv", tmp_path / "p.npz")


def test_a_link_stays_and_its_file_is_replaced(tmp_path):
    (tmp_path / "disk").mkdir()
    link = tmp_path / "t.npz"
    link.symlink_to("disk/t.npz")
    for content in (b"first", b"second"):
        check_target(link)
        with whole_file(link) as stream:
            stream.write(content)
        assert link.is_symlink() and (tmp_path / "disk" / "t.npz").read_bytes() == content
    assert len(list((tmp_path / "disk").iterdir())) == 1


def test_names_as_long_as_the_system_allows_can_be_written(tmp_path):
    path = tmp_path / ("n" * 251 + ".npz")
    with whole_file(path) as stream:
        stream.write(b"x")
    assert path.read_bytes() == b"x"
