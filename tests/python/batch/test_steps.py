# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that are run for a clip."""

from pathlib import Path

from mimetic.batch.clip_list import Row
from mimetic.batch.steps import Settings, steps_of


def test_a_character_gets_few_keys_too_and_no_detail(tmp_path):
    row = Row(str(tmp_path / "clip.mp4"), character=f"{tmp_path / 'rig.blend'}:Head")
    paths = [tmp_path / name for name in ("clip.mp4", "rig.blend", "performance.npz")]
    for path in paths:
        path.write_bytes(path.name.encode())

    def character(settings):
        return steps_of(row, settings, Path(tmp_path))[-1]

    dense = character(Settings())
    few = character(Settings(("blend",), with_detail=True, tolerance=0.05))
    assert "--few-keys=0.05" in few.words and "--detail" not in few.words
    assert not any("--few-keys" in word for word in dense.words)
    assert len({dense.key(), few.key(), character(Settings(tolerance=0.1)).key()}) == 3
    assert character(Settings(with_detail=True)).key() == dense.key()


def test_a_rate_of_pictures_leaves_video_files_alone(tmp_path):
    for number in range(2):
        (tmp_path / f"frame_{number}.png").write_bytes(b"picture")
    (tmp_path / "clip.mp4").write_bytes(b"clip")

    def capture(clip, fps):
        return steps_of(Row(str(tmp_path / clip), fps=fps), Settings(), tmp_path)[0]

    assert len({capture("clip.mp4", fps).key() for fps in ("", "24", "25")}) == 1
    assert len({capture("frame_0.png", fps).key() for fps in ("", "24", "25")}) == 3
    assert "--fps=25" in capture("frame_0.png", "25").words
