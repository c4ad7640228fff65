# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.character.mesh_frame import marks_of, now_from_noted


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(1).normal(scale=8, size=(2000, 3)).astype(np.float32)


def test_an_applied_transform_is_found_of_a_few_vertices(points):
    turned = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    applied = turned * np.array([0.01, 0.01, 0.02])
    shift = np.array([0.3, -0.2, 1.5])
    now = (points @ applied.T + shift).astype(np.float32)
    marks = marks_of(points)
    found = now_from_noted(points[marks], now[marks])
    np.testing.assert_allclose(points @ found[:3, :3].T + found[:3, 3], now, atol=1e-6)


@pytest.mark.parametrize("how", ["nothing", "one vertex", "bent", "flat"])
def test_what_is_no_transform_of_the_whole_changes_nothing(points, how):
    before, now = points.copy(), points.copy()
    marks = marks_of(points)
    if how == "one vertex":
        now[marks[3], 1] += 0.05
    if how == "bent":
        now[:, 2] += 0.01 * now[:, 0] ** 2
    if how == "flat":
        before[:, 2], now = 0, 2 * now
    np.testing.assert_array_equal(now_from_noted(before[marks], now[marks]), np.eye(4))


def test_a_mesh_of_few_vertices_has_marks():
    assert set(marks_of(np.eye(3))) == {0, 1, 2}
