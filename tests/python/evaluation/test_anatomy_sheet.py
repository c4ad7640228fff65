# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.template.face_template import load_template

from evaluation.anatomy import anatomy_sheet
from evaluation.anatomy.head_painter import IRIS, PUPIL, Painter


def test_the_sheet_is_written_whole(tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    out = tmp_path / "sheet.png"
    chosen = ["neutral", "jaw_open", "anger 100%"]
    arguments = ["--out", str(out), "--size", "60", "--only", *chosen]
    assert anatomy_sheet.main(arguments) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["sheet.png"]
    picture = imread(out)
    assert picture.shape[1] == pytest.approx(3 * 2 * 60, abs=2)
    neutral, opened, angry = np.split(picture[:, :360, :3], 3, axis=1)
    assert np.abs(neutral - opened).mean() > 0.01
    assert np.abs(neutral - angry).mean() > 0.001


def test_an_unknown_picture_is_named(capsys, tmp_path):
    assert anatomy_sheet.main(["--out", str(tmp_path / "a.png"), "--only", "third_eye"]) == 2
    assert "third_eye" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_eyes_are_painted_in_the_middle():
    template = load_template()
    rest = np.asarray(template.vertices)
    painter = Painter(template, 300, 0.0, "lid_upper.L")
    picture = painter.paint(rest, np.zeros_like(rest))
    dark = np.argwhere(picture.sum(axis=2) < 3 * 0.25)
    assert len(dark) > 20
    assert PUPIL < IRIS
    middle = dark.mean(axis=0) / picture.shape[:2]
    np.testing.assert_allclose(middle, 0.5, atol=0.15)
