# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes and teeth of a filmed head are as bright as its footage shows the eyes' whites."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic.character import face_paint
from mimetic.character.appearance import (
    DARKEST_EYES,
    Surface,
    appearance_of,
    iris_colour,
    light_on_eyes,
)
from mimetic.library.composing import canonical_person
from mimetic.template.face_template import load_template
from PIL import Image


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


def surfaces(person, colour=None, folder=None) -> dict[str, Surface]:
    """Of a face that was filmed in one colour, or never."""
    path = None
    if colour is not None:
        width, height = person.image_size
        path = folder / "0001.png"
        Image.fromarray(np.full((height, width, 3), colour, dtype=np.uint8)).save(path)
    return {surface.name: surface for surface in appearance_of(person, path).surfaces}


def test_the_mouths_inside_is_lit_as_the_eyes_are(person, tmp_path):
    painted = surfaces(person)
    dim = surfaces(person, (60, 60, 60), tmp_path)
    bright = surfaces(person, (250, 250, 250), tmp_path)
    np.testing.assert_allclose(bright["Teeth"].colour, painted["Teeth"].colour)
    teeth = np.array(dim["Teeth"].colour) / painted["Teeth"].colour  # of linear light
    assert (teeth > 0.05).all() and (teeth < 0.2).all()
    for name in ("Mouth", "Tongue"):  # behind the teeth
        assert (np.array(dim[name].colour) / painted[name].colour < teeth).all()
        assert (np.array(bright[name].colour) < painted[name].colour).all()


def iris_of(person, colour) -> np.ndarray:
    """Of a picture in which eyes have white whites and irises of a colour; as it is seen, sRGB."""
    template = load_template()
    width, height = person.image_size
    image = np.full((height, width, 3), 190, dtype=np.uint8)
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    points = person.surface_in_camera(0)
    for side in "LR":
        eye = np.asarray(template.part_vertices(f"eye.{side}"))
        pupil = points[eye[np.argmax(template.vertices[eye, 2])]]
        x, y = person.project(pupil[None])[0]
        radius = person.intrinsics[0, 0] * 0.006 / pupil[2]
        image[np.hypot(columns - x, rows - y) < radius] = colour
    uv = face_paint.fill_square(template)
    light = light_on_eyes(person, 0, image, template, uv)
    return iris_colour(person, 0, image, template, uv, light) * light * 255


@pytest.mark.parametrize("colour", [(90, 110, 140), (70, 45, 30), (80, 100, 70)])
def test_irises_have_the_colour_that_is_filmed(person, colour):
    np.testing.assert_allclose(iris_of(person, colour), colour, atol=6)


def test_irises_of_a_few_pixels_are_brown(person):
    far = person.head_pose.copy()
    far[:, 2, 3] *= 20
    template = load_template()
    width, height = person.image_size
    image = np.full((height, width, 3), 150, dtype=np.uint8)
    small, uv = replace(person, head_pose=far), face_paint.fill_square(template)
    iris = iris_colour(small, 0, image, template, uv, np.ones(3))
    np.testing.assert_array_equal(iris, face_paint.BROWN)
