# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the paper's figures 2 and 15."""

import numpy as np
from clips import make_numbered_clip
from PIL import Image
from sample_performance import make_performance

from evaluation.runs import film_strip, loops


def test_a_strip_shows_frames_from_the_first_to_the_last(tmp_path):
    clip, out = make_numbered_clip(tmp_path / "clip.mkv", "-c:v", "ffv1"), tmp_path / "strip.png"
    assert film_strip.main([str(clip), "--frames", "4", "--height", "64", "--out", str(out)]) == 0
    with Image.open(out) as opened:
        strip = np.asarray(opened.convert("L"))
    assert strip.shape == (64, 4 * 64)
    shown = strip.reshape(64, 4, 64).mean((0, 2)) / 5  # the frames' numbers
    np.testing.assert_allclose(shown, [1, 14, 27, 40], atol=1)


def test_both_loops_are_drawn_of_the_same_frames_alone(tmp_path, capsys):
    paper, ours, out = (tmp_path / name for name in ("paper.npz", "ours.npz", "loops.png"))
    make_performance().save(paper)
    quiet = make_performance()
    quiet.activations[:, quiet.groups != 3] *= 0.1
    quiet.save(ours)
    assert loops.most_moved(quiet, 1) == [3]
    assert loops.main([str(paper), str(ours), "--out", str(out)]) == 0
    with Image.open(out) as picture:
        assert picture.size == (1100, 700)
    make_performance(num_frames=7).save(ours)
    assert loops.main([str(paper), str(ours), "--out", str(out)]) == 2
    assert "not of the same frames" in capsys.readouterr().err
