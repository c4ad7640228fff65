# SPDX-License-Identifier: GPL-3.0-or-later
"""Events that begin before another has gone, and what a delay between two curves means."""

import numpy as np
import pytest
from mimetic import _core

FRAMES = np.arange(1.0, 141.0)
NOISE, QUIET = 0.01, 0.004


def options() -> _core.PhaseOptions:
    """As `mimetic analyse` has them."""
    chosen = _core.PhaseOptions()
    chosen.measured_std, chosen.shape_error = 1e-9, 2.5
    chosen.robust_scale, chosen.exponent_std = 0.02, 3.0
    return chosen


def events_of(values: np.ndarray, frames: np.ndarray = FRAMES) -> list[_core.PhaseFit]:
    stds = np.full(len(frames), 0.05)
    return _core.fit_phases(frames, values, stds, [True] * len(frames), options())


def twice(valley: float, onset: float, random: np.random.Generator) -> np.ndarray:
    """A ramp to .7 that falls to a valley, from which a second one rises and falls to rest."""
    first = np.interp(FRAMES, [20, 30, 45], [0, 0.7, 0.7])
    falling = valley + (0.7 - valley) * np.exp(-(FRAMES - 45) / 5)
    values = np.where(FRAMES > 45, falling, first)
    rising = valley + (0.7 - valley) * (FRAMES - onset) / 10
    values = np.where(onset < FRAMES, np.minimum(rising, 0.7), values)
    release = onset + 18
    values = np.where(release < FRAMES, 0.7 * np.exp(-(FRAMES - release) / 6), values)
    return values + NOISE * random.standard_normal(len(FRAMES))


@pytest.mark.parametrize("valley", [0.15, 0.25, 0.35])
def test_an_onset_is_told_where_another_event_has_not_gone(valley):
    held = 0
    for seed in range(8):
        random = np.random.default_rng(seed)
        onset = random.uniform(72, 75)
        second = events_of(twice(valley, onset, random))[-1]
        held += second.onset.lower <= onset <= second.onset.upper
        assert second.onset.value == pytest.approx(onset, abs=1.75)
        assert second.shape.before == pytest.approx(valley, abs=0.04)
        assert second.shape.climb == pytest.approx(0.7 - valley, abs=0.05)
        assert second.amplitude.value == pytest.approx(0.7, abs=0.05)  # above rest
    assert held >= 7  # of 8 intervals of 95 %


def test_an_event_that_begins_at_rest_is_applied_from_rest():
    values = twice(0.0, 90.0, np.random.default_rng(0))
    assert [event.shape.before for event in events_of(values)] == [None, None]


def event_at(onset: float, rise: float, amplitude: float = 0.6) -> np.ndarray:
    shape = _core.PhaseShape()
    shape.onset, shape.rise, shape.hold = onset, rise, 10.0
    shape.amplitude, shape.release_time = amplitude, 6.0
    return shape.values(FRAMES)


def test_a_group_that_begins_first_and_rises_slowly_is_not_called_later():
    for seed in range(6):
        random = np.random.default_rng(seed)
        curves = [
            event_at(onset, rise) + QUIET * random.standard_normal(len(FRAMES))
            for onset, rise in ((50.0, 10.0), (48.0, 26.0))
        ]
        (leader,), (follower,) = map(events_of, curves)
        delay = _core.estimate_delay(FRAMES, curves[0], leader, curves[1], follower)
        assert delay.lag.value > 1 and delay.onset_lag < 0
        assert not delay.is_delayed


def test_a_later_group_of_the_same_shape_is_called_later():
    random = np.random.default_rng(0)
    curves = [
        event_at(onset, 10.0) + QUIET * random.standard_normal(len(FRAMES)) for onset in (50, 53)
    ]
    (leader,), (follower,) = map(events_of, curves)
    assert _core.estimate_delay(FRAMES, curves[0], leader, curves[1], follower).is_delayed


def test_chance_counts_smaller_events_that_match_as_well():
    """Of the follower, whose other events are half as high as the one beside the leader's."""
    frames = np.arange(1.0, 1001.0)
    shape = _core.PhaseShape()
    shape.rise, shape.hold, shape.release_time, shape.amplitude = 8.0, 6.0, 4.0, 0.7
    curves = [np.zeros(len(frames)), np.zeros(len(frames))]
    shape.onset = 100.0
    curves[0] += shape.values(frames)
    for onset in range(102, 960, 50):
        shape.onset, shape.amplitude = float(onset), 0.7 if onset == 102 else 0.35
        curves[1] = np.maximum(curves[1], shape.values(frames))
    random = np.random.default_rng(0)
    curves = [curve + 0.002 * random.standard_normal(len(frames)) for curve in curves]
    (leader,), followers = (events_of(curve, frames) for curve in curves)
    delay = _core.estimate_delay(frames, curves[0], leader, curves[1], followers[0])
    assert delay.chance > 0.03
