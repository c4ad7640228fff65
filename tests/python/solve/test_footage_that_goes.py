# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage that goes away while it is followed: its share is unmounted, or it is moved."""

import shutil

import pytest
from mimetic.commands import console
from mimetic.commands.cli import main
from mimetic.performance.document import Performance
from mimetic.solve.clip_capture import find_face


@pytest.mark.parametrize("command", ["capture", "head"])
def test_what_was_followed_is_kept_beside_earlier_results(
    rendered_clip, tmp_path, monkeypatch, capsys, command
):
    clip, out = tmp_path / "clip.mkv", tmp_path / "out"
    shutil.copy(rendered_clip.footage, clip)
    find_face(clip, frame=25).save(tmp_path / "fit.json")
    out.mkdir()
    (out / "performance.npz").write_bytes(b"of an earlier run")

    class Moving(console.Console):
        def show(self, fraction, text):
            super().show(fraction, text)
            if text.startswith("following the") and ": frame" in text and clip.exists():
                clip.rename(tmp_path / "elsewhere.mkv")

    monkeypatch.setattr("mimetic.commands.on_clip.Console", Moving)
    words = [command, clip, "--fit", tmp_path / "fit.json", "--out", out]
    assert main([str(word) for word in words]) == 1
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith(f"mimetic: {clip}: it went away while it was read (No such file")
    assert (out / "performance.npz").read_bytes() == b"of an earlier run"
    kept = Performance.load(out / "unfinished" / "performance.npz")
    # What was before the fit's frame had been decoded; what comes after it had not
    assert kept.frame.tolist() == list(range(1, 26))
    assert any("frames 26 to 50 could not be read: it went away" in note for note in kept.notes)
