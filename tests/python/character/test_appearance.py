# SPDX-License-Identifier: GPL-3.0-or-later
"""The whites of a filmed head's eyes are as bright as its footage shows them."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic.character import face_paint
from mimetic.character.appearance import DARKEST_EYES, light_on_eyes
from mimetic.library.composing import canonical_person
from mimetic.template.face_template import load_template


@pytest.fixture(scope="module")
def person():
    return canonical_person()


def light(person, colour) -> np.ndarray:
    width, height = person.image_size
    image = np.full((height, width, 3), colour, dtype=np.uint8)
    template = load_template()
    return light_on_eyes(person, 0, image, template, face_paint.fill_square(template))


@pytest.mark.parametrize("grey", [110, 170])
def test_eyes_are_as_bright_as_they_are_seen(person, grey):
    whites = light(person, (grey, grey, grey)) * face_paint.SCLERA
    np.testing.assert_allclose(whites, grey / 255, atol=0.02)


def test_half_of_a_tint_is_the_lids(person):
    red = light(person, (150, 75, 75)) * face_paint.SCLERA
    assert red[0] == pytest.approx(150 / 255, abs=0.01)
    assert 85 / 255 < red[1] < 125 / 255


def test_eyes_are_never_brighter_than_painted_nor_black(person):
    np.testing.assert_allclose(light(person, (255, 255, 255)), 1, atol=1e-9)
    np.testing.assert_allclose(light(person, (0, 0, 0)), DARKEST_EYES, atol=1e-9)


def test_eyes_that_are_shut_are_still_painted(person):
    values = person.articulator_values.copy()
    for k, name in enumerate(person.articulators):
        if name.startswith("lid_"):
            values[0, k] = 1.0
    found = light(replace(person, articulator_values=values), (90, 60, 50))
    assert np.isfinite(found).all() and (found >= DARKEST_EYES).all() and (found <= 1).all()
    behind = person.head_pose.copy()
    behind[0, :3, :3] = behind[0, :3, :3] @ np.diag([-1.0, 1.0, -1.0])
    assert np.isfinite(light(replace(person, head_pose=behind), (90, 60, 50))).all()
