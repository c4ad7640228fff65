# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces in little light, and such one side of which is in the dark."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_face import draw
from mimetic import _core
from mimetic.fit.fitting import FaceFit, find_face, judge_frame
from mimetic.template.face_template import load_template

CAMERA = _core.Camera(600, 600, 239.5, 199.5, 480, 400)
HEAD = np.array([[1, 0, 0, 0.01], [0, -1, 0, -0.01], [0, 0, -1, 0.6], [0, 0, 0, 1.0]])


@pytest.fixture(scope="module")
def face():
    template = load_template()
    return draw(template, template.vertices, HEAD, CAMERA)


def lit_from_one_side(image: np.ndarray, dark: float, is_left: bool) -> np.ndarray:
    """Light falls to `dark` over 40 pixels about the face's middle; noise as of a camera."""
    x = np.arange(image.shape[1])
    share = np.clip((x - 249.5) / 40 + 0.5, 0, 1)
    light = 1 + (dark - 1) * (1 - share if is_left else share)
    noise = np.random.default_rng(3).normal(0, 1, image.shape)
    return np.clip(np.round(image * light[:, None] + noise), 0, 255).astype(np.uint8)


def turn_deg(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(a[:3, :3].T @ b[:3, :3]) - 1) / 2, -1, 1))))


def dimmed(image: np.ndarray, light: float) -> np.ndarray:
    noise = np.random.default_rng(3).normal(0, 1, image.shape)
    return np.clip(np.round(light * image + noise), 0, 255).astype(np.uint8)


def assert_alike(well: FaceFit, badly: FaceFit) -> None:
    pupils = well.features["pupil.L"][0] - well.features["pupil.R"][0]
    places = [np.array([fit.features[name] for name in well.features]) for fit in (well, badly)]
    assert np.median(np.linalg.norm(places[1] - places[0], axis=1)) < 0.03 * pupils
    assert turn_deg(well.head_pose, badly.head_pose) < 4


@pytest.fixture(scope="module")
def fitted(face):
    return find_face(face)


@pytest.mark.parametrize("is_left", (True, False))
def test_a_face_with_a_dark_side_is_fitted_as_in_even_light(face, fitted, is_left):
    assert_alike(fitted, find_face(lit_from_one_side(face, 0.1, is_left)))


@pytest.mark.parametrize("light", (0.15, 0.06))
def test_a_face_in_little_light_is_fitted_as_in_much(face, fitted, light):
    assert_alike(fitted, find_face(dimmed(face, light)))


def test_only_badly_lit_pictures_are_made_brighter(face):
    found = judge_frame(face)
    assert found is not None
    assert _core.well_lit(face, found.features) is face
    half = lit_from_one_side(face, 0.15, True)
    lit = _core.well_lit(half, found.features)
    dark, bright = (slice(150, 260), slice(210, 235)), (slice(150, 260), slice(265, 290))
    assert half[dark].mean() < 0.3 * half[bright].mean()
    assert lit[dark].mean() > 0.45 * lit[bright].mean()
    assert np.abs(lit[bright].astype(float) - half[bright]).mean() < 15
    assert lit.shape == half.shape and lit.dtype == np.uint8
    dim = dimmed(face, 0.1)
    assert _core.well_lit(dim, found.features)[bright].mean() > 3 * dim[bright].mean()
