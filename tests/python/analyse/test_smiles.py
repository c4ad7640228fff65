# SPDX-License-Identifier: GPL-3.0-or-later
"""Which events a smile is compared with."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.analyse.smiles import EYES, MOUTH, smiles_of
from mimetic.analyse.timing import Curve, Event


def event(group, onset, release, amplitude, name="", last=None):
    """An event as it is fitted, without errors; last: row to which it is seen."""

    def at(value):
        return SimpleNamespace(value=value, lower=value, upper=value)

    fit = SimpleNamespace(
        onset=at(onset),
        apex=at(onset + 3),
        release=at(release),
        length=at(release + 10 - onset),
        amplitude=at(amplitude),
        shape=SimpleNamespace(amplitude=amplitude, climb=amplitude),
        first=onset - 8,
        last=release + 18 if last is None else last,
        is_certain=True,
        begins_before=False,
        ends_after=last is not None,
    )
    curve = SimpleNamespace(group=group, name=name)
    return SimpleNamespace(curve=curve, fit=fit, amplitude=fit.amplitude)


def smile_among(groups, sides=(), delays=()):
    timing = SimpleNamespace(
        performance=SimpleNamespace(fps=25.0, frame=np.arange(400)),
        of_group=lambda group: [one for one in groups if one.curve.group == group],
        of_kind=lambda kind: [*sides],
        delays=[*delays],
    )
    (smile,) = smiles_of(timing)
    return smile


def test_a_blink_before_a_smile_is_not_its_eyes():
    mouth, blink = event(MOUTH, 100, 130, 0.7), event(EYES, 89, 95, 0.35)
    eyes = event(EYES, 105, 128, 0.6)
    pairs = [SimpleNamespace(leader=mouth, follower=one) for one in (blink, eyes)]
    smile = smile_among([mouth, blink, eyes], delays=pairs)
    assert smile.eye_event is eyes and smile.eye_delay is pairs[1]
    assert smile.eye_ratio.value == pytest.approx(0.6 / 0.7)
    assert smile_among([mouth, blink], delays=pairs[:1]).eye_event is None


def test_sides_of_a_smile_are_those_of_its_time():
    """A stronger one that ends as the smile begins is another smile's."""
    left, right = (event(MOUTH, 100, 130, a, f"{MOUTH}{s}") for a, s in ((0.3, ".L"), (0.5, ".R")))
    earlier = [event(MOUTH, 46, 95, 0.6, f"{MOUTH}{side}") for side in (".L", ".R")]
    smile = smile_among([event(MOUTH, 101, 131, 0.4)], sides=[*earlier, left, right])
    assert smile.asymmetry.value == pytest.approx((0.3 - 0.5) / 0.8)


def test_eyes_of_another_scene_are_not_a_smiles():
    """What is held until a cut is fitted beyond it."""
    mouth, eyes = event(MOUTH, 40, 145, 0.7, last=80), event(EYES, 95, 109, 0.6)
    assert smile_among([mouth, eyes]).eye_event is None
    within = event(EYES, 60, 75, 0.6)
    assert smile_among([mouth, within]).eye_event is within


def test_an_amplitude_counts_that_a_groups_muscles_are_wrong_together():
    fit = event(MOUTH, 100, 130, 0.4).fit
    members = np.array([1.0, 1, 1, 1])
    curve = Curve("group", "a", MOUTH, np.zeros(3), np.full(3, 0.05), 0.1, members)

    def half_width(measured_std):
        amplitude = Event(replace(curve, measured_std=measured_std), 1, fit).amplitude
        assert amplitude.value == 0.4 and amplitude.lower == max(0, 0.8 - amplitude.upper)
        return amplitude.upper - 0.4

    assert half_width(0.1) > 1.96 * 0.1  # not a half of it, as of the mean of four that differ
    assert 0.2 < half_width(0.001) < half_width(0.1) < half_width(0.3)
