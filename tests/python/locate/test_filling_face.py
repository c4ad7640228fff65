# SPDX-License-Identifier: GPL-3.0-or-later
"""A face that fills its picture, as a camera on a helmet has it."""

import numpy as np
import pytest
from mimetic.fit import fitting
from mimetic.media.footage import Footage
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.template.face_template import load_template

from evaluation.runs.real_labels import footage_of

NAMES = ("pupil.L", "pupil.R", "mouth_corner.L", "mouth_corner.R")


def places_of(face) -> np.ndarray:
    """NAMES x 2, pixels."""
    places = {feature.name: feature.position for feature in face.features}
    return np.array([places[name] for name in NAMES])


@pytest.mark.parametrize(("clip", "frame"), [("single_face", 13), ("cap12_edit", 22)])
def test_it_is_found_where_it_is_with_room_about_it(clip, frame):
    image = np.ascontiguousarray(Footage(footage_of(clip)).read(frame))
    locator = fitting._locator()
    (whole,) = locator.locate(image)
    left, top, width, height = whole.box
    corner = np.round([left + 0.06 * width, top + 0.1 * height]).astype(int)
    x, y = corner
    tight = np.ascontiguousarray(image[y : y + round(0.92 * height), x : x + round(0.88 * width)])
    (face,) = locator.locate(tight)
    pupils = places_of(whole)[:2]
    apart = np.linalg.norm(pupils[1] - pupils[0])
    off = places_of(face) + corner - places_of(whole)
    assert np.linalg.norm(off, axis=1).max() < 0.1 * apart
    fit, template = fitting.find_face(tight), load_template()
    fronts = eye_geometry(fit.neutral_vertices(template), template).fronts()
    off = fit.camera.pixels(fronts, fit.head_pose) + corner - pupils
    assert np.linalg.norm(off, axis=1).max() < 0.12 * apart


def test_a_picture_without_a_face_has_none():
    noise = np.random.default_rng(3).integers(0, 256, (240, 320, 3), dtype=np.uint8)
    assert fitting._locator().locate(noise) == []
    with pytest.raises(fitting.NoFace):
        fitting.find_face(noise)
