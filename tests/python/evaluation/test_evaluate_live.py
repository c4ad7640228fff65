# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of `mimetic evaluate live`, on curves whose lag and likeness are known."""

import numpy as np
import pytest
from looking_performance import make_looking

from evaluation.runs.live_score import common_rows, correlations, curves_of, lag_of


def curves(shift=0.0, scale=1.0):
    """A muscle's group that comes and goes, seen `shift` frames late."""
    frames = np.arange(200) - shift
    bumps = sum(np.exp(-0.5 * ((frames - at) / 4) ** 2) for at in (30, 80, 120, 165))
    return {"group 1": scale * 0.6 * bumps, "group 2": np.zeros(200)}


@pytest.mark.parametrize("lag", [0.0, 0.4, 1.0, 2.5])
def test_a_lag_is_recovered_between_frames(lag):
    assert lag_of(curves(lag), curves()) == pytest.approx(lag, abs=0.1)


def test_a_correlation_is_of_what_moves():
    figures = correlations(curves(0.5, 0.7), curves())
    assert 0.98 < figures["group 1"] < 1 and np.isnan(figures["group 2"])
    assert correlations(curves(12), curves())["group 1"] < 0.3


def test_held_frames_are_compared_with_nothing(performance):
    other = np.ones(performance.num_frames)
    performance = type(performance)(**{**vars(performance), "quality": other.copy()})
    other[3] = 0.0
    held = type(performance)(**{**vars(performance), "quality": other})
    rows, rows_of_held = common_rows(performance, held)
    assert len(rows) == performance.num_frames - 1 and 3 not in rows
    assert rows.tolist() == rows_of_held.tolist()


def test_curves_are_of_groups_jaw_lids_gaze_and_head():
    looking = make_looking()
    found = curves_of(looking, np.arange(looking.num_frames))
    assert {"group 1", "group 7", "jaw", "lids", "gaze", "yaw", "pitch", "roll"} <= set(found)
    assert all(len(curve) == looking.num_frames for curve in found.values())
