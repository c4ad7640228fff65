# SPDX-License-Identifier: GPL-3.0-or-later
"""A head follows the mouse by which its pose is stated."""

import numpy as np
import pytest
from mimetic.library.composing import canonical_person
from mimetic.solve.stated_pose import PoseDrag, turned
from mimetic.template.face_template import load_template

FRAME = 1
STATED = ((0.0, 4.0, 3.0), (0.01, 0.0, -0.02))  # before the drag


@pytest.fixture(scope="module")
def person():
    return canonical_person()


def pixel_of(person, pose, point) -> np.ndarray:
    return person.project((pose[:3, :3] @ point + pose[:3, 3])[None])[0]


def drag(person, mode: str, begin, end) -> tuple[np.ndarray, np.ndarray]:
    """Poses before and after it."""
    dragged = PoseDrag(person, FRAME, *STATED).dragged(tuple(begin), tuple(end), mode)
    return turned(person, FRAME, *STATED), turned(person, FRAME, *dragged)


def test_a_head_that_is_moved_stays_under_the_mouse(person):
    before, after = drag(person, "move", (300.0, 200.0), (330.0, 188.0))
    moved = pixel_of(person, after, np.zeros(3)) - pixel_of(person, before, np.zeros(3))
    np.testing.assert_allclose(moved, (30, -12), atol=1e-6)
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=1e-12)
    assert after[2, 3] == pytest.approx(before[2, 3])


def test_a_head_is_turned_by_its_face(person):
    nose = load_template().vertices[load_template().landmark("nose_tip")]
    begin = pixel_of(person, turned(person, FRAME, *STATED), nose)
    for way in ((14.0, 0.0), (0.0, 14.0), (-9.0, -9.0)):
        before, after = drag(person, "turn", begin, begin + way)
        moved = pixel_of(person, after, nose) - begin
        assert moved @ way / np.dot(way, way) == pytest.approx(1, abs=0.35), way
        assert abs(np.cross(moved, way)) < 0.3 * np.dot(way, way), "along the mouse's way"
        np.testing.assert_array_equal(after[:3, 3], before[:3, 3])


def test_a_head_is_rolled_about_its_middle(person):
    middle = pixel_of(person, turned(person, FRAME, *STATED), np.zeros(3))
    before, after = drag(person, "roll", middle + np.array((60, 0)), middle + np.array((0, 60)))
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # clockwise in sight
    np.testing.assert_allclose(after[:3, :3], quarter @ before[:3, :3], atol=1e-6)
    np.testing.assert_array_equal(after[:3, 3], before[:3, 3])
