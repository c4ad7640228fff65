# SPDX-License-Identifier: GPL-3.0-or-later
import os
import re
import subprocess
import sys

import pytest
from mimetic import __version__
from mimetic.commands import cli
from mimetic.commands.cli import main
from sample_performance import make_performance


def test_version_and_help_name_the_commands(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip() == f"mimetic {__version__}"
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert all(name in text for name in cli.COMMANDS)


@pytest.mark.parametrize(
    "name", ["calibrate", "capture", "head", "points", "evaluate", "info", "bake", "batch"]
)
def test_every_command_has_help(name, capsys):
    assert main([name, "--help"]) == 0
    assert name in capsys.readouterr().out


def test_help_of_one_command_imports_no_plots():
    code = "import sys, mimetic.commands.cli; mimetic.commands.cli.main(['info', '--help']); " + (
        "sys.exit(bool({'matplotlib', 'rich', 'cv2', 'bpy'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


def test_unknown_commands_and_missing_arguments_are_bad_input(capsys):
    assert main([]) == 2
    assert main(["sing"]) == 2
    assert main(["info"]) == 2
    assert "usage" in capsys.readouterr().err


def test_info_tells_what_is_in_a_performance(tmp_path, capsys):
    make_performance(notes=["stopped by the user"]).save(tmp_path / "p.npz")
    assert main(["info", str(tmp_path / "p.npz")]) == 0
    text = capsys.readouterr().out
    assert re.search(r"frames +1 to 12, 12 in all, 23\.976 a second", text)
    assert "320 x 240" in text and "jaw_open" in text and "stopped by the user" in text


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("absent.npz", None, "no such file"),
        ("text.npz", b"hello", "is not a performance"),
        ("empty.npz", b"", "is not a performance"),
    ],
)
def test_bad_files_are_one_line_and_status_2(tmp_path, capsys, name, content, message):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    assert main(["info", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("mimetic: ") and error.count("\n") == 1
    assert name in error and message in error


@pytest.mark.parametrize("frames", ["5", "0:3", "9:2", "a:b", "1:2:3", "-1:4"])
def test_frames_that_make_no_sense_are_refused(tmp_path, capsys, frames):
    assert main(["capture", "clip.mp4", "--out", str(tmp_path), f"--frames={frames}"]) == 2
    assert "frames" in capsys.readouterr().err


def test_names_that_are_no_text_can_be_told(tmp_path):
    make_performance().save(tmp_path / "p.npz")
    (tmp_path / "at.csv").write_text("x,y\n150,100\n")
    out = os.fsencode(tmp_path) + b"/\xe9\xff.npz"
    ran = subprocess.run(
        [sys.executable, "-m", "mimetic", "points", "p.npz", "--at", "at.csv", "--out", out],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "LC_ALL": "C.UTF-8"},
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "udce9" in ran.stdout and os.path.exists(out)


@pytest.mark.parametrize("words", [["--help"], ["bake", "--help"], ["--version"]])
@pytest.mark.parametrize("buffering", [{}, {"PYTHONUNBUFFERED": "1"}])
def test_help_into_a_closed_pipe_ends_without_a_word(words, buffering):
    reading, writing = os.pipe()
    os.close(reading)  # as `mimetic --help | true`
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"} | buffering
    command = [sys.executable, "-m", "mimetic", *words]
    try:
        ended = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, env=environment)
    finally:
        os.close(writing)
    assert ended.returncode == 1 and ended.stderr == b""
