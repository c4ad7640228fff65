# SPDX-License-Identifier: GPL-3.0-or-later
"""The core's stage `puppet` as Python sees it."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core


@pytest.fixture(scope="module")
def picture() -> np.ndarray:
    random = np.random.default_rng(3)
    coarse = random.uniform(0, 255, (16, 20))
    return np.kron(coarse, np.ones((8, 8))).astype(np.uint8)


def cut(picture: np.ndarray, x: int, y: int) -> np.ndarray:
    return np.ascontiguousarray(picture[y : y + 24, x : x + 24])


def test_a_template_is_found_where_it_was_cut_out(picture):
    place = [[50 + 11.5, 40 + 11.5]]
    matcher = _core.TemplateMatcher([cut(picture, 50, 40)], place, [0])
    scores, places, _, found_again = matcher.match(picture)
    assert scores[0] > 0.999 and not found_again
    np.testing.assert_allclose(places, place, atol=0.05)
    moved = np.ascontiguousarray(np.roll(picture, (3, -5), axis=(0, 1)))
    np.testing.assert_allclose(matcher.match(moved)[1], [[56.5, 54.5]], atol=0.05)


def test_pictures_and_templates_that_do_not_fit_are_refused(picture):
    with pytest.raises(InvalidInput, match="a picture, a place and a group"):
        _core.TemplateMatcher([cut(picture, 0, 0)], [[1, 1]], [])
    matcher = _core.TemplateMatcher([cut(picture, 50, 40)], [[60, 50]], [0])
    with pytest.raises(InvalidInput, match="height, width"):
        matcher.match(np.zeros((40, 40, 3), np.uint8))
    with pytest.raises(InvalidInput, match="larger than the image"):
        _core.correlation_map(cut(picture, 0, 0), picture)


def test_interpolation_meets_its_examples():
    scores = np.array([[0.9, 0.5], [0.6, 1.0], [0.7, 0.7]])
    states = np.array([[0.0, 0.2], [1.0, 0.1], [0.4, 0.6]])
    options = _core.InterpolationOptions()
    options.regularisation = 1e-12
    map_ = _core.Interpolation(scores, states, np.zeros(2), np.ones(2), options)
    for row, state in zip(scores, states, strict=True):
        np.testing.assert_allclose(map_.state(row), state, atol=1e-4)
    weights = _core.hull_weights(states, np.array([0.5, 0.1]))
    assert weights.min() >= 0 and weights.sum() == pytest.approx(1)


def test_the_filter_states_its_lag():
    filter_ = _core.LowLagFilter(np.ones(1))
    outs = [filter_.advance(np.array([0.02 * k]), 1 / 25)[0] for k in range(100)]
    behind = (0.02 * 99 - outs[-1]) / 0.5
    assert behind == pytest.approx(filter_.lags[0], rel=1e-6)
