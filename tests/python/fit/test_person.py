# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's head, known from other footage, is put where the face is, and keeps its shape."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.person import with_person
from mimetic.muscles.calibration import Calibration
from mimetic.template.face_template import load_template

CAMERA = _core.Camera(700.0, 700.0, 319.5, 239.5, 640, 480)


def turned(yaw, away):
    """Camera from head: facing the camera, turned about the head's own axis, metres away."""
    pose = np.diag([1.0, -1, -1, 1])
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    pose[:3, :3] = pose[:3, :3] @ turn
    pose[:3, 3] = 0.01, 0.02, away
    return pose


def fit_of(values, pose, seen_values, seen_pose):
    """A fit of one shape and pose whose face was measured where another head has it."""
    template = load_template()
    model = face_model(template)
    seen = _core.FaceEstimate([seen_pose], CAMERA.fx, seen_values)
    projected = _core.project_features(model, seen, CAMERA)
    features = [_core.Feature(f.name, f.position, 0.5, 0.9) for f in projected.features]
    measured = _core.FaceFeatures(features, [], np.array([200.0, 100, 240, 300]), 0.9)
    identity, residual = face_shape(template).split(values)
    return FaceFit(
        frame=3,
        image_size=(640, 480),
        intrinsics=np.array([[700.0, 0, 319.5], [0, 700, 239.5], [0, 0, 1]]),
        head_pose=pose,
        identity=identity,
        residual=residual,
        views=[FittedView(3, pose, measured)],
    )


@pytest.fixture(scope="module")
def shapes():
    """Component values of the person's head and of what was fitted instead."""
    rng = np.random.default_rng(4)
    count = len(face_shape(load_template()).components)
    return 0.6 * rng.normal(size=count), 0.6 * rng.normal(size=count)


def test_the_head_keeps_the_persons_shape_and_stands_where_the_face_is(shapes):
    template = load_template()
    own, other = shapes
    true_pose, wrong_pose = turned(0.2, 0.6), turned(0.1, 0.62)
    person = fit_of(own, turned(0.0, 0.5), own, turned(0.0, 0.5))
    person.calibration = Calibration({"cheeks": 1.8}, frames=[4, 9])
    fit = fit_of(other, wrong_pose, own, true_pose)
    shared = with_person(fit, person, template)
    apart = shared.neutral_vertices(template) - person.neutral_vertices(template)
    assert np.abs(apart).max() < 1e-12
    assert shared.calibration == person.calibration and shared.frame == fit.frame
    turn = shared.head_pose[:3, :3].T @ true_pose[:3, :3]
    assert np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))) < 1.5
    assert np.abs(shared.head_pose[:3, 3] - true_pose[:3, 3]).max() < 0.006
    assert shared.error < 0.01 < 2 * with_person(fit, fit, template).error
    assert np.array_equal(shared.views[0].head_pose, shared.head_pose)
    assert np.array_equal(fit.head_pose, wrong_pose)  # what was given stays


def test_a_frame_may_be_a_number_of_numpys(tmp_path, shapes):
    own, _ = shapes
    fit = replace(fit_of(own, turned(0.0, 0.5), own, turned(0.0, 0.5)), frame=np.int64(3))
    fit.views = [replace(fit.views[0], frame=np.int32(3))]
    fit.save(tmp_path / "fit.json")
    assert FaceFit.load(tmp_path / "fit.json").frame == 3
    for wrong in (np.float64(3), np.int64(0), True, "3"):
        with pytest.raises(InvalidInput, match="face fit's frame is"):
            replace(fit, frame=wrong)


def test_the_core_keeps_proportions_that_are_known(shapes):
    own, other = shapes
    pose = turned(0.2, 0.6)
    view = fit_of(own, pose, own, pose).views[0]
    start = _core.FaceEstimate([turned(0.1, 0.62)], 700.0, other)
    model = face_model(load_template())
    held, free = (
        _core.fit_face(model, [view.observed()], CAMERA, start=start, shape_free=is_free)
        for is_free in (False, True)
    )
    assert np.array_equal(held.identity, other)
    assert np.abs(free.identity - own).mean() < np.abs(other - own).mean()


def test_a_head_that_cannot_be_the_persons_is_refused(shapes):
    own, _ = shapes
    far_off = 12 * np.ones_like(own)
    pose = turned(0.0, 0.6)
    fit = fit_of(own, pose, own, pose)
    with pytest.raises(InvalidInput, match="same person"):
        with_person(fit, fit_of(far_off, pose, far_off, pose))


def test_a_fit_without_views_is_refused(shapes):
    own, _ = shapes
    pose = turned(0.0, 0.6)
    fit = fit_of(own, pose, own, pose)
    old = fit_of(own, pose, own, pose)
    old.views = []
    with pytest.raises(InvalidInput, match="older version"):
        with_person(old, fit)
