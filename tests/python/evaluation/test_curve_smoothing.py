# SPDX-License-Identifier: GPL-3.0-or-later
"""What smoothing takes off a clip is told beside what it leaves."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from sample_performance import make_performance

from evaluation.runs.curve_smoothing import as_text, scores_of


def test_jitter_goes_and_short_blinks_lose_height():
    frames = np.arange(120)
    blink = np.clip(1.5 - abs(frames - 60) / 2, 0, 1)
    jitter = 0.02 * (-1.0) ** frames
    performance = make_performance(120, articulators=["lid_upper.L", "jaw_open"])
    performance = dataclasses.replace(
        performance,
        activations=np.clip(performance.activations + jitter[:, None], 0, 1),
        articulator_values=np.column_stack([blink, 0 * blink]),
    )
    scores = list(scores_of("clip", performance))
    assert (scores[0].jitter, scores[0].peaks, scores[0].blinks) == pytest.approx((1, 1, 1))
    for before, after in pairwise(scores):
        assert after.jitter < before.jitter
        assert after.blinks <= before.blinks + 1e-9
    assert scores[-1].blinks < 0.6
    assert "clip, 0.08 s" in as_text(scores)
