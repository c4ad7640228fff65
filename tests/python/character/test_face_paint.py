# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain pictures: colours land where the anatomy is."""

from __future__ import annotations

import numpy as np
import pytest
from mimetic.character.face_paint import fill_square, paint_eye, paint_lashes, paint_skin
from mimetic.template.face_template import load_template

SIZE = 512


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def skin(template):
    return paint_skin(template, fill_square(template), SIZE)


def color_at(template, picture, landmark):
    """Mean of the texels round a landmark."""
    uv, vertex = fill_square(template), template.landmark(landmark)
    place = uv[template.faces == vertex][0] * SIZE
    column, row = int(place[0]), SIZE - 1 - int(place[1])
    return picture[row - 2 : row + 3, column - 2 : column + 3].mean((0, 1))


def test_the_skin_fills_the_square(template):
    uv = fill_square(template)[template.part_faces("skin")]
    assert uv.min() == pytest.approx(0.01, abs=1e-6)
    assert uv.max() == pytest.approx(0.99, abs=1e-6)


def test_lips_are_redder_and_brows_darker_than_the_forehead(template, skin):
    forehead = color_at(template, skin, "glabella")
    for lip in ("lip_upper_inner", "lip_lower_inner"):
        color = color_at(template, skin, lip)
        assert color[0] / color[1] > 1.15 * forehead[0] / forehead[1]
    for brow in ("brow_middle.L", "brow_middle.R"):
        assert color_at(template, skin, brow).mean() < 0.8 * forehead.mean()
    assert color_at(template, skin, "chin").mean() > 0.9 * forehead.mean()


def test_a_seed_gives_the_same_skin(template):
    uv = fill_square(template)
    first, again, other = (paint_skin(template, uv, 64, seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.01


def test_an_eye_has_pupil_iris_and_sclera():
    eye = paint_eye(360)  # a texel a degree
    assert eye[180, 180].max() < 0.1
    assert 0.05 < eye[180, 180 + 14].mean() < 0.5
    assert eye[180, 180 + 30].mean() > 0.8


def test_lashes_thin_out_towards_their_tips():
    alpha = paint_lashes(600, 60)[..., 3]
    assert alpha.shape == (60, 600)
    assert 0.1 < alpha[-1].mean() < 0.5  # skin is seen between them
    assert alpha[0].mean() < 0.01
    coverage = alpha.mean(1)
    assert (np.diff(coverage) >= -0.02).all()
