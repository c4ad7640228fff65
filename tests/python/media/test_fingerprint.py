# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.shared.fingerprint import fingerprint, is_same


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(1).normal(scale=0.1, size=(5166, 3)).astype(np.float32)


def test_rounding_is_no_change(points):
    shift = np.float32(0.0123)
    offsets = np.random.default_rng(2).normal(scale=2e-3, size=points.shape).astype(np.float32)
    first = points + offsets
    moved = (first + shift) - (points + shift)
    largest = float(np.abs(points).max())
    assert is_same(fingerprint(offsets), fingerprint(first - points), largest)
    assert is_same(fingerprint(offsets), fingerprint(moved), largest)


@pytest.mark.parametrize("axis", range(3))
def test_one_point_that_moved_a_tenth_of_a_millimetre_is_seen(points, axis):
    largest = float(np.abs(points).max())
    for i in range(0, len(points), 517):
        other = points.copy()
        other[i, axis] += 1e-4
        assert not is_same(fingerprint(points), fingerprint(other), largest)


def test_any_number_of_points_has_one():
    assert fingerprint(np.zeros((0, 3))).tolist() == [0.0] * 8
    assert fingerprint(np.ones((1_000_000, 3))).shape == (8,)
