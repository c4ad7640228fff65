# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two people's readings are told to agree, and whether a linear map carries over."""

import numpy as np
import pytest

from evaluation.runs.consistency import LANDMARKS, MUSCLES, Consistency, Person, person_of

UNITS = ["smile", "frown", "never shown"]
NUM_FRAMES = 60


def person(number: int, smile: np.ndarray, mix: np.ndarray) -> Person:
    """Who smiles and frowns by turns; readings are the units by `mix`, with a little noise."""
    rng = np.random.default_rng(number)
    values = np.zeros((NUM_FRAMES, len(UNITS)))
    values[:, 0] = np.clip(np.sin(np.linspace(0, 7, NUM_FRAMES) + number), 0, 1)
    values[:, 1] = rng.uniform(0, 1, NUM_FRAMES)
    readings = values @ mix + rng.normal(0, 0.01, (NUM_FRAMES, mix.shape[1]))
    own_way = values @ rng.normal(size=mix.shape)
    return Person(
        f"person {number}", {"smile": smile}, {MUSCLES: readings, LANDMARKS: own_way}, UNITS, values
    )


@pytest.fixture
def people() -> Consistency:
    mix = np.random.default_rng(0).normal(size=(len(UNITS), 5))
    smiles = ([1, 0, 0.2], [0.9, 0, 0.2], [0, 1, 0], [1, 0.1, 0.1])
    return Consistency([person(i, np.array(one, float), mix) for i, one in enumerate(smiles)])


def test_patterns_are_compared_between_every_two_people(people):
    cosines = people.cosines("smile")
    assert len(cosines) == 6
    assert cosines["person 0", "person 1"] == pytest.approx(0.9998, abs=1e-3)
    assert min(cosines, key=cosines.get) in (("person 0", "person 2"), ("person 1", "person 2"))


def test_a_map_learned_on_others_decodes_what_is_read_alike(people):
    alike, own_way = people.decoded(MUSCLES), people.decoded(LANDMARKS)
    assert set(alike) == {"smile", "frown"}  # what nobody shows has no correlation
    assert min(alike.values()) > 0.98
    assert max(own_way.values()) < 0.9


def test_a_reading_that_some_hardly_have_does_not_spoil_what_is_decoded(people):
    for i, one in enumerate(people.people):
        trace = np.full((NUM_FRAMES, 1), 1e-6 * i)
        trace[::7] += 0.5 if i == 3 else 1e-6  # a muscle that one person alone used
        one.readings[MUSCLES] = np.hstack([one.readings[MUSCLES], trace])
    assert min(people.decoded(MUSCLES).values()) > 0.9


def test_a_persons_pattern_is_that_of_an_expressions_height(performance, truth):
    truth.expressions = ["first", "second"]
    middle = len(truth.frame) // 2
    truth.expression_frames = np.array(
        [[truth.frame[0], truth.frame[middle]], [truth.frame[middle + 1], truth.frame[-1]]]
    )
    truth.units, truth.unit_values = ["smile"], np.zeros((len(truth.frame), 1))
    truth.unit_values[1] = truth.unit_values[-1] = 1
    marks = np.arange(min(5, len(performance.neutral_vertices)))
    seen = person_of("somebody", truth, performance, marks)
    np.testing.assert_allclose(seen.patterns["first"], performance.activations[1])
    np.testing.assert_allclose(seen.patterns["second"], performance.activations[-1])
    assert seen.readings[LANDMARKS].shape == (performance.num_frames, 3 * len(marks))
    moved = performance.surface(1)[marks] - performance.neutral_vertices[marks]
    np.testing.assert_allclose(seen.readings[LANDMARKS][1], moved.ravel(), atol=1e-9)
