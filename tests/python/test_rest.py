# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame at rest is found within its clip, by what a part of the face does most of the time."""

import numpy as np
from mimetic.evaluate import Truth
from mimetic.pipeline import find_face
from mimetic.rest import usual_expression

NEUTRAL = np.array([-0.35, -0.36, 1.2, 1.22, 0.28, 0.78])


def test_parts_that_move_at_different_times_are_usual_only_at_rest():
    rng = np.random.default_rng(2)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[2:6, :2] -= 0.08  # brows up
    clip[8:12, 2:4] -= 0.06  # a smile lifts the corners of the mouth
    clip[8:12, 5] += 0.1
    usual = usual_expression(clip, np.ones(16))
    at_rest = np.r_[0:2, 6:8, 12:16]
    assert usual[at_rest].min() > 0.3
    assert np.delete(usual, at_rest).max() < 0.1


def test_a_smile_that_lasts_most_of_the_clip_is_not_its_rest():
    rng = np.random.default_rng(3)
    clip = NEUTRAL + rng.normal(0, 0.004, (16, 6))
    clip[5:, 4] -= 0.07  # teeth show between the lips
    clip[5:, 2:4] -= 0.1
    scores = np.where(np.arange(16) < 5, 0.7, 0.007)
    chances = scores * usual_expression(clip, scores)
    assert chances[:5].min() > 0.2
    assert chances[5:].max() < 0.01


def test_features_not_found_do_not_count():
    clip = np.tile(NEUTRAL, (6, 1))
    clip[2, :2] = np.nan
    np.testing.assert_allclose(usual_expression(clip, np.ones(6)), 1)
    clip[:, 0] = np.nan
    np.testing.assert_allclose(usual_expression(clip, np.ones(6)), 1)


def test_the_reference_frame_of_the_rendered_clip_is_at_rest(rendered_clip):
    truth = Truth.load(rendered_clip.truth)
    frame = find_face(rendered_clip.footage).frame
    assert truth.unit_values[frame - 1].max() < 0.15
