# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake` before it asks Blender, and where it does not."""

import os

import numpy as np
import pytest
from clips import make_clip
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands import bake as bake_command
from mimetic.commands import cli
from mimetic.commands.bake import bake
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.footage import Footage
from mimetic.report.beside import BesideDrawing
from mimetic.retarget.controls import ControlRow, save_preset
from sample_performance import make_performance


@pytest.fixture
def clips(tmp_path):
    """The clip that was captured, and another one of the same size."""
    paths = tmp_path / "own.mp4", tmp_path / "other.mp4"
    for path, content in zip(paths, (b"own", b"fro"), strict=True):
        path.write_bytes(content)
    return paths


def test_footage_of_another_film_is_refused_before_blender_is_asked(clips, tmp_path):
    own, other = clips
    performance = make_performance(footage=["own.mp4", fingerprint(own)])
    performance.save(tmp_path / "p.npz")
    no_blender = tmp_path / "no python"
    with pytest.raises(InvalidInput, match=r"other.mp4 is not the clip that .* \(own.mp4\)"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", other, no_blender)
    with pytest.raises(UnreadableMedia, match="no python"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", own, no_blender)


def test_footage_of_a_performance_that_names_none_is_taken(clips, tmp_path):
    make_performance(footage=None).save(tmp_path / "p.npz")
    with pytest.raises(UnreadableMedia, match="no python"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", clips[1], tmp_path / "no python")


@pytest.mark.parametrize("how", ["its name", "a link", "the preset's"])
def test_what_a_target_is_read_from_is_not_replaced(tmp_path, capsys, how):
    make_performance().save(tmp_path / "p.npz")
    rig, preset, out = (tmp_path / name for name in ("rig.blend", "preset.json", "out.blend"))
    rig.write_bytes(b"BLENDER")
    save_preset([ControlRow("smile")], preset)
    if how == "its name":
        out = rig
    elif how == "a link":
        out.symlink_to(rig.name)
    else:
        os.link(preset, out)
    before = out.read_bytes()
    words = ["bake", tmp_path / "p.npz", "--target", f"{rig}:Hero", "--preset", preset]
    status = cli.main([*map(str, words), "--out", str(out), "--blender-python", "none"])
    assert status == 2
    assert "would replace what is read; give another name" in capsys.readouterr().err
    assert out.read_bytes() == before


def test_a_name_of_two_lines_is_said_in_one(tmp_path, capsys, monkeypatch):
    make_performance().save(tmp_path / "p.npz")
    monkeypatch.setitem(bake_command.TABLES, ".csv", lambda performance, out: "written")
    out = tmp_path / "face\nof two.csv"
    assert cli.main(["bake", str(tmp_path / "p.npz"), "--out", str(out)]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert "face\\nof two.csv: " in line


def test_a_video_shows_face_and_footage_in_all_frames(tmp_path, capsys):
    clip = make_clip(tmp_path / "clip.mp4", size="320x240", frames=12)
    make_performance(footage=["clip.mp4", fingerprint(clip)]).save(tmp_path / "p.npz")
    arguments = ["bake", tmp_path / "p.npz", "--footage", clip, "--out", tmp_path / "face.mp4"]
    assert cli.main([str(argument) for argument in arguments]) == 0
    assert "12 frames" in capsys.readouterr().out
    video = Footage(tmp_path / "face.mp4")
    assert video.num_frames == 12 and video.size[0] == 1280
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clip.mp4", "face.mp4", "p.npz"]


def test_a_video_needs_footage_and_takes_no_keys(tmp_path):
    clip = make_clip(tmp_path / "clip.mp4", size="320x240", frames=12)
    make_performance().save(tmp_path / "p.npz")
    paths = tmp_path / "p.npz", tmp_path / "face.mp4"
    with pytest.raises(InvalidInput, match="give --footage"):
        bake(*paths)
    with pytest.raises(InvalidInput, match="leave --action-units"):
        bake(*paths, clip, tolerance=0.02)
    with pytest.raises(InvalidInput, match="target is written as"):
        bake(*paths, clip, target={"file": "rig.blend", "object": "Rig"})
    assert not (tmp_path / "face.mp4").exists()


def test_a_video_of_footage_without_its_frames_says_so(tmp_path):
    clip = make_clip(tmp_path / "clip.mp4", size="320x240", frames=3)
    late = np.arange(12) + 40
    make_performance(frame=late).save(tmp_path / "p.npz")
    with pytest.raises(UnreadableMedia, match="none of the frames 40 to 51"):
        bake(tmp_path / "p.npz", tmp_path / "face.mp4", clip)
    assert not (tmp_path / "face.mp4").exists()


def test_an_interrupted_video_leaves_nothing(tmp_path, monkeypatch):
    clip = make_clip(tmp_path / "clip.mp4", size="320x240", frames=12)
    make_performance().save(tmp_path / "p.npz")
    frames = iter(range(5))

    def paint(drawing, image, i):
        if next(frames) == 3:
            raise KeyboardInterrupt
        return np.zeros((64, 64, 3), dtype=np.uint8)

    monkeypatch.setattr(BesideDrawing, "paint", paint)
    arguments = ["bake", tmp_path / "p.npz", "--footage", clip, "--out", tmp_path / "face.mp4"]
    assert cli.main([str(argument) for argument in arguments]) == 130
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clip.mp4", "p.npz"]
