# SPDX-License-Identifier: GPL-3.0-or-later
"""Lids and lips of a fitted head that move to where the networks see them."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import moved_model
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.line_fit import with_lines
from mimetic.fit.line_modes import line_modes
from mimetic.muscles.feature_lines import feature_lines
from mimetic.template.face_template import load_template

POSE = np.diag([1.0, -1.0, -1.0, 1.0])
POSE[2, 3] = 0.6


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def modes(template):
    return line_modes(template)


def rms_of_all(modes, vertices):
    """Metres by which all modes together move vertices, at one prior standard deviation."""
    return np.sqrt((modes[:, vertices] ** 2).sum(axis=(0, 2)))


def test_the_modes_end_near_lids_and_lips(template, modes):
    at_lines = rms_of_all(modes, feature_lines(template)["lip_upper"]).mean()
    away = [template.landmark(name) for name in ("nose_tip", "menton", "hairline", "tragus.L")]
    assert at_lines > 0.001
    assert rms_of_all(modes, away).max() < 0.1 * at_lines
    for part in ("eye.L", "eye.R", "teeth_upper", "tongue"):
        assert not modes[:, template.part_vertices(part)].any()


def test_lids_slide_on_the_eyeballs(template, modes):
    lines = feature_lines(template)
    for side, centre in zip("LR", template.eye_centers, strict=True):
        vertices = [v for lid in ("upper", "lower") for v in lines[f"lid_{lid}.{side}"][4:-4]]
        outward = template.vertices[vertices] - centre
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        moved = modes[:, vertices]
        off = np.sqrt(((moved * outward).sum(axis=2) ** 2).sum(axis=0))
        assert off.max() < 0.15 * rms_of_all(modes, vertices).min()


def test_every_mode_is_alike_or_opposed_on_both_sides(template, modes):
    skin = template.num_skin_vertices
    opposite = modes[:, template.mirror[:skin]] * [-1.0, 1.0, 1.0]
    parity = (modes[:, :skin] * opposite).sum(axis=(1, 2)) / (modes[:, :skin] ** 2).sum(axis=(1, 2))
    assert (np.abs(np.abs(parity) - 1) < 0.02).all()
    assert (parity > 0).any() and (parity < 0).any()


def fit_of(features):
    return FaceFit(
        frame=1,
        image_size=(640, 480),
        intrinsics=np.array([[700.0, 0, 319.5], [0, 700.0, 239.5], [0, 0, 1]]),
        head_pose=POSE,
        identity={},
        views=[FittedView(1, POSE, features)],
    )


def seen_of(template, neutral, modes, raised=0.0):
    """The lines of a head as networks would see them; raised: pixels, of the upper lids alone."""
    model = moved_model(template, neutral, modes)
    camera = fit_of(_core.FaceFeatures([], [], np.zeros(4), 1.0)).camera
    estimate = _core.FaceEstimate([POSE], 700.0, np.zeros(len(modes)))
    seen = _core.project_features(model, estimate, camera)
    curves = []
    for curve in seen.curves:
        if curve.name in feature_lines(template):
            places = np.array(curve.points)[1:-1]
            places[:, 1] -= raised * curve.name.startswith("lid_upper")
            normals = np.tile([0.0, 1.0], (len(places), 1))
            curves.append(_core.FeatureCurve(curve.name, places, normals, np.ones(len(places))))
    others = ("pupil", "nose", "ala", "brow", "glabella", "menton", "hairline", "gonion")
    features = [f for f in seen.features if f.name.startswith(others)]
    return _core.FaceFeatures(features, curves, np.zeros(4), 1.0)


def line_places(template, fit, name):
    return fit.camera.pixels(fit.neutral_vertices(template)[feature_lines(template)[name]], POSE)


def test_lids_go_to_where_they_are_seen_and_nothing_else_does(template, modes):
    neutral = template.neutral({})
    fit = fit_of(seen_of(template, neutral, modes, raised=2.0))
    moved = with_lines(fit, (), template)
    for side in "LR":
        before, after = (line_places(template, f, f"lid_upper.{side}") for f in (fit, moved))
        raised = (before - after)[4:-4, 1]
        assert 1.0 < raised.mean() < 2.2  # of 2 pixels, against the prior
    for name in ("lid_lower.L", "lip_upper", "lip_lower"):
        before, after = (line_places(template, f, name) for f in (fit, moved))
        assert np.abs(before - after).mean() < 0.25
    np.testing.assert_array_equal(moved.head_pose, fit.head_pose)


def test_frames_are_averaged_and_count_as_one(template, modes):
    neutral = template.neutral({})
    high, low = (seen_of(template, neutral, modes, raised) for raised in (1.2, -1.2))
    alone = with_lines(fit_of(high), (), template)
    twice = with_lines(fit_of(high), [FittedView(2, POSE, high)], template)
    between = with_lines(fit_of(high), [FittedView(2, POSE, low)], template)
    heights = [
        line_places(template, fit, "lid_upper.L")[4:-4, 1].mean()
        for fit in (fit_of(high), alone, twice, between)
    ]
    assert abs(heights[2] - heights[1]) < 0.25 * abs(heights[1] - heights[0])  # some is pose
    assert abs(heights[3] - heights[0]) < 0.35 * abs(heights[1] - heights[0])


def test_a_frame_in_which_an_eye_is_shut_says_nothing_of_the_lids(template, modes):
    neutral = template.neutral({})
    open_eyes, shut = (seen_of(template, neutral, modes, raised) for raised in (0.0, -8.0))
    others = [FittedView(2, POSE, open_eyes), FittedView(3, POSE, open_eyes)]
    without = with_lines(fit_of(open_eyes), others, template)
    blinking = with_lines(fit_of(open_eyes), [*others, FittedView(4, POSE, shut)], template)
    assert blinking.lines == without.lines


def test_a_reference_with_shut_eyes_stays_the_reference(template, modes):
    neutral = template.neutral({})
    open_eyes, shut = (seen_of(template, neutral, modes, raised) for raised in (0.0, -8.0))
    others = [FittedView(2, POSE, open_eyes), FittedView(3, POSE, open_eyes)]
    moved = with_lines(fit_of(shut), others, template)
    lowered = [
        line_places(template, f, "lid_upper.L")[4:-4, 1].mean() for f in (fit_of(shut), moved)
    ]
    assert lowered[1] > lowered[0] + 0.5  # pixels: what it shows counts still


def test_a_fit_that_networks_did_not_see_stays(template):
    fit = fit_of(_core.FaceFeatures([], [], np.zeros(4), 1.0))
    assert with_lines(fit, (), template) is fit


def test_the_lines_are_kept_in_the_file(template, modes, tmp_path):
    fit = with_lines(fit_of(seen_of(template, template.neutral({}), modes, 2.0)), (), template)
    fit.save(tmp_path / "fit.json")
    again = FaceFit.load(tmp_path / "fit.json")
    np.testing.assert_array_equal(again.neutral_vertices(template), fit.neutral_vertices(template))
    assert (
        np.abs(
            replace(fit, lines=[]).neutral_vertices(template) - fit.neutral_vertices(template)
        ).max()
        > 1e-4
    )
