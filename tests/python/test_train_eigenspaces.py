# SPDX-License-Identifier: GPL-3.0-or-later
"""People are drawn for training as said: repeatably, with their parts where they are cut out."""

import numpy as np
import pytest

from scripts.eigenspaces.training import FACE_SIDE, MODULES, PICTURES_A_PERSON, samples_of


@pytest.fixture(scope="module")
def samples():
    return samples_of(1000)


def test_patches_are_of_the_sizes_said(samples):
    assert samples.faces.shape == (PICTURES_A_PERSON, FACE_SIDE, FACE_SIDE)
    for patches, (_, (width, height)) in zip(samples.modules, MODULES.values(), strict=True):
        assert patches.shape == (PICTURES_A_PERSON, height, width)
    assert np.ptp(samples.yaws) > 20


def test_the_parts_lie_in_the_face_as_in_a_face(samples):
    left, right, nose, mouth = samples.places.mean(0)
    assert right[0] < nose[0] < left[0]  # the subject's left is the picture's right
    assert max(left[1], right[1]) < nose[1] < mouth[1]
    assert np.hypot(*(left - right)) == pytest.approx(0.5, rel=0.15)  # two IPDs a patch


def test_pupils_are_dark_in_their_patches(samples):
    for patches in samples.modules[:2]:
        middle = patches[:, 4:8, 6:10].mean((1, 2))
        assert (middle < patches.mean((1, 2))).mean() > 0.8


def test_a_person_is_drawn_the_same_again(samples):
    again = samples_of(1000)
    np.testing.assert_array_equal(again.faces, samples.faces)
    np.testing.assert_array_equal(again.places, samples.places)
