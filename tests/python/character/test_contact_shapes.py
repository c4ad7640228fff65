# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact over time as few shapes with curves."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.contact_shapes import shapes_of_corrections

MOVED = np.array([1, 3, 4])


def test_shapes_add_up_to_the_corrections_and_are_still_elsewhere():
    random = np.random.default_rng(3)
    basis = random.normal(scale=1e-3, size=(2, 3, 3))
    corrections = {i: basis[0] * i - basis[1] / (1 + i) for i in (2, 5, 6)}
    shapes = shapes_of_corrections(corrections, 8, MOVED, 6)
    assert [shape.name for shape in shapes] == ["contact.000", "contact.001"]
    for i in range(8):
        total = sum(shape.values[i] * shape.offsets for shape in shapes)
        expected = np.zeros((6, 3))
        expected[MOVED] = corrections.get(i, 0.0)
        assert np.abs(total - expected).max() < 5e-5
    assert all(np.abs(shape.values).max() == 1 for shape in shapes)


def test_no_correction_gives_no_shape():
    assert shapes_of_corrections({}, 4, MOVED, 6) == []


def test_a_correction_of_a_frame_beyond_the_take_is_refused():
    with pytest.raises(InvalidInput, match="one of 4 frames"):
        _core.shapes_of_corrections(np.zeros((1, 9)), [4], 4)
