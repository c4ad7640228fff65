# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips encoded again and captured by several textures."""

from pathlib import Path

import numpy as np
import pytest
from mimetic.media.footage import Footage

from evaluation.runs import compressed


@pytest.fixture(scope="module")
def made(rendered_clip, tmp_path_factory):
    folder = tmp_path_factory.mktemp("encoded")
    return dict(compressed.encodings(rendered_clip.footage, [20, 40], folder))


def test_clips_keep_their_frames_and_lose_what_is_fine(rendered_clip, made):
    assert list(made) == ["as drawn", "crf 20", "crf 40"]
    assert made["as drawn"] == rendered_clip.footage
    drawn = Footage(rendered_clip.footage)
    pictures = {name: Footage(path).read(9).astype(float) for name, path in made.items()}
    for path in made.values():
        footage = Footage(path)
        assert (footage.num_frames, footage.size, footage.fps) == (
            *(drawn.num_frames, drawn.size, drawn.fps),
        )
    lost = {
        name: np.abs(picture - pictures["as drawn"]).mean() for name, picture in pictures.items()
    }
    assert 0 < lost["crf 20"] < lost["crf 40"] / 2
    assert Path(made["crf 40"]).stat().st_size < Path(made["crf 20"]).stat().st_size / 3


@pytest.mark.parametrize("wrong", [["--tracker", "crop=300"], ["--crf", "52"], ["--set", "full"]])
def test_a_wrong_call_is_told_before_anything_is_drawn(wrong, capsys):
    try:
        assert compressed.main(wrong) == 2
    except SystemExit as end:
        assert end.code == 2
    assert wrong[-1].partition("=")[0] in capsys.readouterr().err
