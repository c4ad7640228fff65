# SPDX-License-Identifier: GPL-3.0-or-later
import os
import stat
import subprocess

import pytest
from mimetic import UnreadableMedia
from mimetic.media.ffmpeg import ffmpeg_program, make_runnable


def test_the_program_runs():
    ran = subprocess.run([ffmpeg_program(), "-version"], capture_output=True, check=True)
    assert ran.stdout.startswith(b"ffmpeg version")


def test_a_program_unpacked_without_its_execute_bit_gets_it_back(tmp_path):
    program = tmp_path / "ffmpeg-linux-x86_64-v7"
    program.write_text("#!/bin/sh\necho ran\n")
    program.chmod(0o640)
    other = tmp_path / "README.md"
    other.touch(0o640)
    make_runnable(tmp_path)
    assert stat.S_IMODE(program.stat().st_mode) == 0o750
    assert not os.access(other, os.X_OK)
    assert subprocess.check_output([program], text=True) == "ran\n"


def test_a_program_that_cannot_be_made_runnable_is_named(tmp_path, monkeypatch):
    program = tmp_path / "ffmpeg-linux-x86_64-v7"
    program.touch(0o640)

    def refuse(self, mode):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(type(program), "chmod", refuse)
    with pytest.raises(UnreadableMedia, match=r"ffmpeg-linux.*IMAGEIO_FFMPEG_EXE"):
        make_runnable(tmp_path)


def test_no_program_at_all_is_unreadable_media(monkeypatch):
    def none_found():
        raise RuntimeError("No ffmpeg exe could be found.")

    monkeypatch.setattr("imageio_ffmpeg.get_ffmpeg_exe", none_found)
    with pytest.raises(UnreadableMedia, match="No ffmpeg exe"):
        ffmpeg_program()
