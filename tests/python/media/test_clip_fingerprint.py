# SPDX-License-Identifier: GPL-3.0-or-later
"""Files are known by their content."""

import os

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.clip_fingerprint import (
    PIECE,
    files_in,
    find_content,
    fingerprint,
    is_fingerprint,
)
from mimetic.performance.document import Performance
from sample_performance import make_performance


def test_a_name_does_not_count_and_content_does(tmp_path):
    first, same, other = (tmp_path / name for name in ("a.mp4", "b.mov", "c.mp4"))
    first.write_bytes(b"film" * 1000)
    same.write_bytes(b"film" * 1000)
    other.write_bytes(b"film" * 999 + b"fils")
    assert fingerprint(first) == fingerprint(same) != fingerprint(other)
    assert is_fingerprint(fingerprint(first))


@pytest.mark.parametrize("place", [0, 20 << 20, (40 << 20) - 1], ids=["first", "middle", "last"])
def test_of_a_large_file_pieces_are_read(tmp_path, place):
    path = tmp_path / "large.mov"
    with path.open("wb") as stream:
        stream.truncate(40 << 20)
    before = fingerprint(path)
    with path.open("r+b") as stream:
        stream.seek(place)
        stream.write(b"x" * min(PIECE, (40 << 20) - place))
    assert fingerprint(path) != before


def test_only_files_have_a_fingerprint(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", "nothing", "."):
        with pytest.raises(UnreadableMedia):
            fingerprint(tmp_path / name)


def test_a_file_is_found_by_its_content(tmp_path):
    deep = tmp_path / "a" / "b"
    deep.mkdir(parents=True)
    (tmp_path / "same size.mp4").write_bytes(b"x" * 10)
    (deep / "other name.mp4").write_bytes(b"y" * 10)
    mark = fingerprint(deep / "other name.mp4")
    assert find_content(mark, files_in(tmp_path)) is None
    assert find_content(mark, files_in(tmp_path, 2)) == deep / "other name.mp4"
    assert list(files_in(tmp_path / "nothing", 2)) == []


def test_linked_folders_are_looked_through_once_and_after_the_others(tmp_path):
    folder = tmp_path / "folder"
    (folder / "b").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    for path in (folder / "b" / "one.mp4", tmp_path / "other" / "two.mp4"):
        path.write_bytes(b"x")
    for name, target in (("a", "b"), ("loop", "."), ("other", "../other"), ("dead.mp4", "none")):
        (folder / name).symlink_to(target)
    found = [folder / "b" / "one.mp4", folder / "other" / "two.mp4"]
    assert list(files_in(folder, 9)) == found
    assert list(files_in(folder, 9, with_dead_links=True)) == [folder / "dead.mp4", *found]
    assert list(files_in(folder)) == []


def test_a_performance_keeps_what_it_is_of(tmp_path):
    mark = "12-" + "a" * 64
    make_performance(footage=["clip.mp4", mark]).save(tmp_path / "take.npz")
    loaded = Performance.load(tmp_path / "take.npz")
    assert loaded.footage == ["clip.mp4", mark]
    assert loaded.is_of(mark)
    assert not loaded.is_of("13-" + "a" * 64)
    assert loaded.is_of("")
    assert make_performance().is_of(mark)


@pytest.mark.parametrize(
    "footage",
    [
        ["../../etc/passwd", "12-" + "a" * 64],
        ["", "12-" + "a" * 64],
        ["clip.mp4", "12"],
        ["clip.mp4"],
        np.array([["clip.mp4", "12-" + "a" * 64]]),
    ],
)
def test_a_performance_of_no_footage_is_refused(footage):
    with pytest.raises(InvalidInput, match="footage"):
        make_performance(footage=footage)
