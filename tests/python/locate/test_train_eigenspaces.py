# SPDX-License-Identifier: GPL-3.0-or-later
"""People are drawn and cut up for training as said: repeatably, their parts where they are."""

import numpy as np
import pytest

from scripts.build.eigenspaces.evidence_weights import logistic
from scripts.build.eigenspaces.pictures import BACKS, FRONTS, Pictures, pictures_of
from scripts.build.eigenspaces.scenes import jumbled, mirrored, portrait
from scripts.build.eigenspaces.windows import FACE_SIDE, MODULES, windows_of


@pytest.fixture(scope="module")
def pictures():
    grey, places, yaw = (np.stack(column) for column in zip(*pictures_of(1000), strict=True))
    return Pictures(grey, places, yaw)


@pytest.fixture(scope="module")
def windows(pictures):
    return windows_of(pictures, np.random.default_rng(3))


def test_a_person_is_seen_from_the_front_and_from_behind(pictures):
    assert (len(pictures.fronts), len(pictures.backs)) == (FRONTS, BACKS)
    assert np.ptp(pictures.yaw[pictures.fronts]) > 20


def test_windows_are_of_the_sizes_said(windows):
    assert np.array(windows.faces).shape == (len(windows.yaws), FACE_SIDE**2)
    assert len(windows.place_yaws) == FRONTS
    for name, (_, (width, height)) in MODULES.items():
        assert np.array(windows.modules[name]).shape == (FRONTS, width * height)


def test_the_parts_lie_in_the_window_as_in_a_face(windows):
    left, right, nose, mouth = np.mean(windows.places, axis=0)
    assert right[0] < nose[0] < left[0]  # the subject's left is the picture's right
    assert max(left[1], right[1]) < nose[1] < mouth[1]
    assert np.hypot(*(left - right)) == pytest.approx(0.5, rel=0.15)  # two IPDs a window


def test_pupils_are_darker_than_their_surroundings(windows):
    for name in ("pupil.L", "pupil.R"):
        flat = np.array(windows.modules[name]).reshape(-1, 12, 16)
        assert flat[:, 4:8, 6:10].mean() < flat.mean()


def test_a_mirrored_picture_keeps_sides_of_the_subject(pictures):
    grey, places = mirrored(pictures.grey[0], pictures.places[0])
    assert places[0, 0] > places[1, 0]
    np.testing.assert_array_equal(grey[:, ::-1], pictures.grey[0])


def test_a_portrait_knows_its_places(pictures):
    scene = portrait(pictures.grey[0], 7, np.random.default_rng(2), pictures.places[0])
    scale = np.linalg.norm(scene.places[0] - scene.places[1])
    scale /= np.linalg.norm(pictures.places[0, 0] - pictures.places[0, 1])
    assert scene.ipd == pytest.approx(40 * scale)
    assert scene.grey.shape == (240, 320)
    mixed = jumbled(scene.grey, np.random.default_rng(2))
    assert mixed.mean() == pytest.approx(scene.grey.mean(), abs=8)


def test_logistic_regression_finds_the_odds():
    rng = np.random.default_rng(1)
    evidence = rng.normal(2, [1, 10], (20000, 2))
    odds = 1 / (1 + np.exp(-(1.5 * evidence[:, 0] - 0.1 * evidence[:, 1] - 2)))
    weights = logistic(evidence, (rng.random(20000) < odds).astype(float))
    np.testing.assert_allclose(weights, [1.5, -0.1, -2], rtol=0.12)


def test_a_person_is_drawn_the_same_again(pictures):
    np.testing.assert_array_equal(pictures_of(1000)[0][0], pictures.grey[0])
