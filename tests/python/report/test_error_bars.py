# SPDX-License-Identifier: GPL-3.0-or-later
from dataclasses import replace

import numpy as np
import pytest
from looking_performance import make_looking
from mimetic.character.shapes import shapes_of, slider_shapes_of
from mimetic.report.error_bars import ErrorBars
from mimetic.score.scores import INTERVAL_90
from sample_performance import make_performance

MUSCLE, OTHER = "muscle_02.L", "muscle_03.R"  # columns 4 and 7


def performance(**changes):
    of = np.full((12, 36), -1)
    of[3:9, 4], of[3:9, 7] = 7, 4
    rest = {"quality": np.ones(12), "articulator_values_std": np.full((12, 2), 0.02)}
    return make_performance(**({"confounded_with": of} | rest | changes))


def test_an_interval_holds_nine_in_ten_of_a_gaussians_values():
    drawn = np.random.default_rng(3).normal(size=200_000)
    assert (np.abs(drawn) < INTERVAL_90).mean() == pytest.approx(0.9, abs=0.003)


def test_the_band_lies_about_what_was_captured():
    one = performance()
    band = ErrorBars(one).band("muscle_00.R")
    assert band.told_apart.shape == (11 * 6, 2) and not len(band.confounded)
    for k, frame in enumerate(one.frame):
        there = band.told_apart[band.told_apart[:, 0] == frame, 1]
        expected = one.activations[k, 1] + INTERVAL_90 * 0.05 * np.array([-1, 1])
        expected = np.clip(expected, 0, 1)  # what an activation can be
        np.testing.assert_allclose([there.min(), there.max()], expected, atol=1e-6)


def test_triangles_cover_the_band_once():
    half = performance(activations=np.full((12, 36), 0.5))
    pieces = ErrorBars(half).band("muscle_00.R").told_apart.reshape(-1, 3, 2)
    one, two = pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0]
    areas = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    assert areas.sum() == pytest.approx(11 * 2 * INTERVAL_90 * 0.05, rel=1e-5)


def test_frames_that_are_not_told_apart_have_a_band_of_their_own():
    bars = ErrorBars(performance())
    band = bars.band(MUSCLE)
    assert sorted(set(band.confounded[:, 0])) == [4, 5, 6, 7, 8, 9]
    assert len(band.confounded) + len(band.told_apart) == 11 * 6
    assert bars.at(MUSCLE, 5).confounded_with == OTHER
    assert bars.at(MUSCLE, 1).confounded_with == ""
    assert not len(bars.band("jaw_open").confounded)


def test_where_the_face_was_lost_or_not_captured_there_is_none():
    quality = np.ones(12)
    quality[6] = 0.1
    frame = np.append(np.arange(1, 10), [20, 21, 22])
    bars = ErrorBars(performance(quality=quality, frame=frame))
    pieces = bars.band(MUSCLE)
    starts = np.concatenate([pieces.told_apart, pieces.confounded])[::6, 0]
    assert sorted(starts) == [1, 2, 3, 4, 5, 8, 20, 21]
    assert (
        bars.at(MUSCLE, 7) is None and bars.at(MUSCLE, 12) is None and bars.at(MUSCLE, 99) is None
    )
    assert bars.at(MUSCLE, 21).half == pytest.approx(INTERVAL_90 * 0.05)


def test_what_no_slider_is_keyed_with_has_none():
    bars = ErrorBars(performance(articulator_values_std=None))
    assert bars.has(MUSCLE) and not bars.has("jaw_open") and not bars.has("detail.000")
    assert bars.at("jaw_open", 3) is None


@pytest.mark.parametrize(("sliders", "shapes"), [(False, shapes_of), (True, slider_shapes_of)])
def test_values_are_those_that_are_keyed(sliders, shapes):
    looking = make_looking(quality=np.ones(12))
    std = np.full(looking.articulator_values.shape, 0.02)
    looking = replace(looking, articulator_values_std=std)
    bars = ErrorBars(looking, sliders)
    keyed = {shape.name: shape.values for shape in shapes(looking)}
    compared = [name for name in keyed if bars.has(name)]
    assert "lid_upper.L" in compared
    for name in compared:
        captured = [bars.at(name, int(frame)).value for frame in looking.frame]
        np.testing.assert_allclose(captured, keyed[name], atol=1e-12)
