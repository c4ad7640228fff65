# SPDX-License-Identifier: GPL-3.0-or-later
"""What lists of takes and editors say of a performance."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.performance.take_facts import facts_of, quality_of
from mimetic.solve.frames_so_far import FramesSoFar
from sample_performance import make_performance


@pytest.fixture
def captured() -> Performance:
    performance = make_performance(3)
    return replace(
        performance, frame=np.array([2, 3, 7]), quality=np.array([0.5 * HELD_QUALITY, 0.6, 1.0])
    )


def test_a_frame_that_was_lost_is_held(captured):
    assert quality_of(captured, 2) == (0.5 * HELD_QUALITY, True, False)
    assert quality_of(captured, 7) == (1.0, False, False)


def test_of_a_frame_that_was_not_captured_nothing_is_known(captured):
    assert quality_of(captured, 4) is None
    assert FramesSoFar().quality_of(4) is None


def test_a_list_says_which_frames_how_well_and_how_they_were_captured(captured):
    facts = facts_of(captured)
    assert (facts.first, facts.last, facts.num_held, facts.held) == (2, 7, 1, [(0, 0)])
    assert facts.quality == pytest.approx(0.6)
    assert (facts.is_calibrated, facts.is_head_alone, facts.num_corrected) == (False, False, 0)
    width, focal = captured.image_size[0], captured.intrinsics[0, 0]
    assert facts.focal_mm == pytest.approx(36 * focal / width)
