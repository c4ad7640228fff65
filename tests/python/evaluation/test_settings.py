# SPDX-License-Identifier: GPL-3.0-or-later
"""A real clip under several settings: what is read of a performance, and what is refused."""

import numpy as np
import pytest
from mimetic import InvalidInput

from evaluation.runs import settings


def test_frames_at_rest_are_two_numbers_in_order():
    assert settings.frame_range("20:55") == (20, 55)
    for wrong in ("20", "a:b", "55:20"):
        with pytest.raises(InvalidInput, match="--rest"):
            settings.frame_range(wrong)


def test_figures_are_of_the_frames_at_rest_and_of_the_widest_jaw(performance):
    at_rest, moved = int(performance.frame[0]), int(performance.frame[-1])
    performance.activations[:] = 0
    performance.activations[-1, 3] = 0.7
    performance.activations[0, 1] = 0.2
    performance.articulator_values[:] = 0
    performance.articulator_values[-1, performance.articulators.index("jaw_open")] = 0.6
    figures = settings.motion(performance, (at_rest, at_rest))
    assert figures["rest"] == pytest.approx(0.2) and figures["articulator"] == 0
    assert figures["jaw"] == pytest.approx(0.6)
    assert settings.motion(performance, (moved, moved))["rest"] == pytest.approx(0.7)


def test_the_jaw_that_goes_aside_with_the_head_is_told_by_its_slope(performance):
    angles = np.linspace(-20, 30, len(performance.frame))
    turn = np.radians(angles)
    performance.head_pose[:, :3, :3] = np.eye(3)
    performance.head_pose[:, 2, 0] = performance.head_pose[:, 0, 2] = np.sin(turn)
    side = performance.articulators.index("jaw_side")
    performance.articulator_values[:, side] = 0.03 * angles + 0.1
    assert settings.motion(performance, None)["aside"] == pytest.approx(0.3)
    performance.articulator_values[:, side] = 0.1
    assert settings.motion(performance, None)["aside"] == pytest.approx(0)


def test_every_column_has_a_key_of_its_own():
    assert len(settings.columns()) == len(settings.RATES) + len(settings.FEATURES)
