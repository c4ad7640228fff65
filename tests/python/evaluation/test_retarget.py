# SPDX-License-Identifier: GPL-3.0-or-later
"""What `mimetic evaluate retarget` plays, and how it counts."""

import numpy as np
from mimetic.template.face_template import load_template

from evaluation.runs import retarget


def test_every_unit_is_once_alone_and_full():
    template = load_template()
    course = retarget.make_course(template)
    np.testing.assert_array_equal(course.weights[course.peaks], np.eye(52))
    assert course.weights.min() >= 0
    assert course.weights.max() <= 1
    both = [template.unit_names.index(f"mouthSmile{side}") for side in ("Left", "Right")]
    mixtures = course.weights[-retarget.MIXTURES :]
    assert ((mixtures > 0).sum(axis=1) == retarget.UNITS_AT_ONCE).all()
    assert (course.weights[:, both] > 0).all(axis=1).any()  # whole expressions are of both sides


def test_a_unit_that_never_plays_counts_as_uncorrelated():
    template = load_template()
    course = retarget.make_course(template)
    fitted = course.weights.copy()
    fitted[:, 3] = 0
    fitted[:, 4] = 0.5 * fitted[:, 4] + 0.1
    limits = np.full(52, 0.7), np.full(52, 0.6)
    of_way = (5, template.unit_names, course, fitted, limits)
    scores = list(retarget._scores("readings", *of_way))
    assert scores[3].correlation == 0
    assert scores[4].correlation > 0.999
    assert abs(scores[4].leak - 0.1) < 1e-9
    assert abs(scores[4].full - 0.6) < 1e-9
    assert (scores[3].linear, scores[3].made) == (0.7, 0.6)
    text = retarget.as_text([*scores, *retarget._scores("nearest surface", *of_way)])
    assert template.unit_names[3] in text.splitlines()[5]  # worst first


def test_the_best_linear_reading_bounds_what_values_tell():
    random = np.random.default_rng(3)
    weights = random.random((200, 2))
    acted = np.stack([weights[:, 0] + 0.1, random.random(200)], axis=1)  # nothing of the second
    first, second = retarget.linear_readings(acted, weights)
    assert first > 0.999
    assert abs(second) < 0.3
