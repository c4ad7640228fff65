# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of measured places, by how far the head is turned."""

import numpy as np
import pytest

from evaluation.runs.turned_flow import Measured, by_turn, main


def test_frames_are_put_together_by_their_turn_and_the_least_comes_first():
    frames = [
        Measured(17.0, np.array([3.0, 4.0]), np.array([0.9, 0.2])),
        Measured(2.0, np.array([1.0]), np.array([0.8])),
        Measured(29.0, np.array([0.0]), np.array([0.8])),
        Measured(31.0, np.array([50.0]), np.array([1.0])),  # farther than any row
    ]
    rows = by_turn(frames)
    assert list(rows) == ["0 to 5 degrees", "15 to 30 degrees"]
    far = rows["15 to 30 degrees"]
    assert far["frames"] == 2 and far["median"] == 3
    assert far["rms"] == pytest.approx(np.sqrt(25 / 3))
    assert far["head_on_median"] == 1.5 and far["head_on_rms"] == pytest.approx(np.sqrt(4.5))


def test_a_setting_that_is_none_is_told_before_anything_is_drawn(capsys):
    assert main(["--tracker", "crop=300"]) == 2
    assert "no number of TrackerOptions is called crop" in capsys.readouterr().err
