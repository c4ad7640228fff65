# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical picture shows each part of a face at one place, however the head is turned."""

import numpy as np
import pytest
from drawn_face import draw
from mimetic import InvalidInput
from mimetic._core import mirror_correlation
from mimetic.fit.canonical_image import canonical_image, canonical_map
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import find_face
from mimetic.template.face_template import load_template
from test_fit import CAMERA, angle_deg, pose

FOCAL = np.array([[600.0, 0, 239.5], [0, 600.0, 199.5], [0, 0, 1]])


@pytest.fixture(scope="module")
def template():
    return load_template()


def true_fit(head_pose):
    return FaceFit(1, (480, 400), FOCAL, head_pose, {})


def alike(first, second):
    (one, seen), (other, seen_too) = first, second
    both = seen & seen_too
    return np.corrcoef(one[both].mean(axis=1), other[both].mean(axis=1))[0, 1]


def test_turned_and_frontal_pictures_agree_where_both_see(template):
    images = [draw(template, template.vertices, pose(yaw, 5, 3), CAMERA) for yaw in (0, 20)]
    frontal = canonical_image(true_fit(pose(0, 5, 3)), images[0], template=template)
    turned = canonical_image(true_fit(pose(20, 5, 3)), images[1], template=template)
    mistaken = canonical_image(true_fit(pose(10, 5, 3)), images[1], template=template)
    assert (frontal[1] & turned[1]).sum() > 0.5 * frontal[1].sum()
    assert alike(frontal, turned) > 0.8
    assert alike(frontal, turned) > alike(frontal, mistaken) + 0.1


def test_map_has_each_pixel_once_and_the_nose_in_the_middle(template):
    shown = canonical_map(template, 64)
    assert len(np.unique(shown.pixel)) == len(shown.pixel)
    np.testing.assert_allclose(shown.weights.sum(axis=1), 1, atol=1e-6)
    tip = template.landmark("nose_tip")
    x = shown.pixel[(shown.corners == tip).any(axis=1)] % 64
    assert abs(x.mean() - 31.5) < 1.5


def test_halves_agree_in_the_true_pose_only(template):
    image = draw(template, template.vertices, pose(20, 0, 0), CAMERA)
    correlations = [
        mirror_correlation(
            *canonical_image(true_fit(pose(yaw, 0, 0)), image, size=96, template=template)
        )
        for yaw in (20, 0, -20)
    ]
    assert correlations[0] > correlations[1] + 0.1
    assert correlations[0] > correlations[2] + 0.1


def test_turned_head_is_fitted_turned(template):
    camera_from_head = pose(20, 0, 0)
    image = draw(template, template.vertices, camera_from_head, CAMERA)
    fit = find_face(image, template=template, camera=CAMERA)
    assert angle_deg(fit.head_pose, camera_from_head) < 8


def test_picture_of_another_clip_and_a_frame_without_view_are_refused(template):
    fit = true_fit(pose(0, 0, 0))
    with pytest.raises(InvalidInput, match="another clip"):
        canonical_image(fit, np.zeros((40, 40, 3), np.uint8), template=template)
    with pytest.raises(InvalidInput, match="frame 9"):
        canonical_image(fit, np.zeros((400, 480, 3), np.uint8), 9, template=template)
