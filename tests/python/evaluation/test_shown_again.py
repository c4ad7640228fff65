# SPDX-License-Identifier: GPL-3.0-or-later
"""The same clip shown in other ways: what must then agree."""

import numpy as np
import pytest
from sample_performance import make_performance

from evaluation.runs.shown_again import AS_IT_IS, BACKWARD, MIRRORED, WAYS, curves, figures

STD = {"articulator_values_std": np.full((12, 2), 0.05)}


def in_a_mirror(performance):
    """As a capture of the mirrored clip would have it: each muscle's curve on its other side."""
    swapped = performance.activations.reshape(12, 18, 2)[:, :, ::-1].reshape(12, 36)
    return make_performance(
        activations=swapped, articulator_values=performance.articulator_values * [1, -1], **STD
    )


def backward(performance):
    return make_performance(
        activations=performance.activations[::-1],
        articulator_values=performance.articulator_values[::-1],
        **STD,
    )


@pytest.mark.parametrize(("way", "shown"), [(MIRRORED, in_a_mirror), (BACKWARD, backward)])
def test_what_is_read_alike_is_not_apart(way, shown):
    first = make_performance(**STD)
    found = figures(first, shown(first), way)
    assert found["within"] == 1
    assert (
        found["muscles"] == found["articulators"] == found["worst"] == pytest.approx(0, abs=1e-12)
    )
    assert figures(first, shown(first), AS_IT_IS)["muscles"] > 0.1


def test_what_the_bars_do_not_allow_counts():
    first = make_performance(activations=np.full((12, 36), 0.5), **STD)
    moved = np.full((12, 36), 0.5)
    moved[:, 0] += 0.3  # 4 standard deviations of the difference
    found = figures(first, make_performance(activations=moved, **STD), AS_IT_IS)
    assert found["worst"] == pytest.approx(0.3)
    assert found["muscles"] == pytest.approx(0.3 / 6)
    active = (np.abs(curves(first, AS_IT_IS)[0]) > 0.1).sum()
    assert found["within"] == pytest.approx(1 - 12 / active)


def test_pictures_are_shown_as_the_way_says():
    frames = np.random.default_rng(1).integers(0, 255, (3, 40, 60, 3)).astype(np.uint8)
    for way, show in WAYS.items():
        shown = show(frames)
        assert shown.dtype == np.uint8
        assert shown.shape == ((3, 20, 30, 3) if way == "half the size" else frames.shape)
    assert (WAYS["moved"](frames)[:, 9:, 16:] == frames[:, :-9, :-16]).all()
    assert (WAYS[MIRRORED](frames)[0, 0, 0] == frames[0, 0, -1]).all()
    assert WAYS["half the size"](np.full_like(frames, 7)).max() == 7


def test_the_noise_of_a_dark_room_is_new_in_each_frame():
    """More of it where it is dark, as a camera has it."""
    frames = np.full((2, 64, 96, 3), 60, np.uint8)
    frames[:, :, 48:] = 200
    first, second = WAYS["dark room"](frames).astype(float)
    dark, bright = first[:, :48], first[:, 48:]
    assert bright.mean() == pytest.approx(0.8 * 200, abs=8)
    change = (second - first)[:, :48]
    assert change.std() == pytest.approx(np.sqrt(2) * dark.std(), rel=0.1)
    assert 5 < bright.std() < dark.std() < 40
