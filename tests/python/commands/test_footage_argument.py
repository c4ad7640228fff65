# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbered pictures on the command line, and their rate."""

import argparse
import re
from pathlib import Path

import pytest
from clips import ffmpeg, make_clip
from mimetic import InvalidInput
from mimetic.commands import cli
from mimetic.commands.cli import main
from mimetic.commands.footage_argument import add_footage_argument, give_rate
from mimetic.media.footage import Footage


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "pictures"
    folder.mkdir()
    ffmpeg("-i", make_clip(tmp_path / "a.mp4"), folder / "frame_%04d.png")
    return folder


def parsed(*words):
    parser = argparse.ArgumentParser()
    add_footage_argument(parser, "one face")
    arguments = parser.parse_args([str(word) for word in words])
    give_rate(arguments)
    return arguments


def test_pictures_play_at_the_rate_that_is_given(folder):
    for named in (folder, folder / "frame_%04d.png", folder / "frame_0001.png"):
        footage = Footage(parsed(named, "--fps", "30").footage)
        assert footage.fps == 30 and footage.num_frames == 10 and not footage.warnings
    assert Footage(parsed(folder).footage).fps == 24


def test_a_video_has_a_rate_of_its_own(folder):
    with pytest.raises(InvalidInput, match="a video file has a rate of its own"):
        parsed(folder.with_name("a.mp4"), "--fps", "30")


# Each with what else it needs
OF_FOOTAGE = {
    "capture": ["capture"],
    "head": ["head"],
    "fit": ["fit"],
    "calibrate": ["calibrate"],
    "puppet_run": ["puppet", "run", "--templates", "set.npz"],
}


def test_every_command_of_footage_takes_its_rate(folder, tmp_path, capfd):
    names = {
        path.stem
        for path in Path(cli.__file__).parent.glob("*.py")
        if re.search(r"^    add_(footage|clip)_arguments?\(parser", path.read_text(), re.M)
    }
    assert names - {"on_clip"} == set(OF_FOOTAGE)  # on_clip: what capture and the like share
    video = folder.with_name("a.mp4")
    for words in OF_FOOTAGE.values():
        command = [*words, str(video), "--out", str(tmp_path / "out"), "--fps", "30"]
        assert main(command) == 2
        assert "--fps is of numbered pictures" in capfd.readouterr().err, words


def test_bad_pictures_are_one_line_and_bad_input(folder, tmp_path, capfd):
    words = ["fit", str(folder), "--out", str(tmp_path / "out")]
    assert main([*words, "--fps", "0"]) == 2
    assert "a rate of 0 frames a second cannot be" in capfd.readouterr().err
    assert main(words) == 2  # pictures, but of nobody
    assert "no frontal face found in frame_####.png" in capfd.readouterr().err
