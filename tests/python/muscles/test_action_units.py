# SPDX-License-Identifier: GPL-3.0-or-later
"""Action units as sliders: two sides that add up, and actions that ramp as FACS animates."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.shapes import shapes_of_units
from mimetic.library.units import unit_expression
from mimetic.muscles.action_units import action_unit, unit_meanings, unit_sides
from mimetic.template.face_template import load_template


@pytest.fixture(scope="module")
def template():
    return load_template()


def test_the_sides_of_every_unit_add_up_to_it_and_mirror_each_other(template):
    sides = unit_sides(template.vertices, template)
    for name in unit_meanings():
        whole = action_unit(name, template.vertices, template).mode
        if name in sides:
            np.testing.assert_array_equal(sides[name], whole)
            continue
        left, right = sides[f"{name}.L"], sides[f"{name}.R"]
        np.testing.assert_allclose(left + right, whole, atol=1e-12)
        assert np.abs(left[template.vertices[:, 0] < -0.0125]).max() == 0
        mirrored = right[template.mirror] * [-1, 1, 1]
        assert np.abs(left - mirrored).max() < 0.1 * np.abs(left).max()
    assert "AU26" in sides and "AU12.L" in sides


def test_sliders_are_of_canonical_heads_alone(template):
    shapes = shapes_of_units(template.vertices)
    assert {shape.group for shape in shapes} == {"Action Units"}
    assert all(len(shape.values) == 0 and shape.highest == 2 for shape in shapes)
    with pytest.raises(InvalidInput, match="known on that one alone"):
        shapes_of_units(template.vertices[:-1])


def test_an_action_rises_and_falls_along_straight_lines():
    one = unit_expression("AU2")
    assert one.channels == ["AU2.L", "AU2.R"] and one.values.max() == 1
    assert np.abs(np.diff(one.values[:24, 0], 2)).max() < 1e-12
    assert one.values[[0, -1]].max() < 1e-12
    assert unit_expression("AU26").channels == ["AU26"]


def test_the_left_share_is_half_in_the_middle():
    points = np.array([[0.0, 0, 0], [0.01, 0, 0], [-0.01, 1, 1], [0.004, 0, 0], [-0.004, 0, 0]])
    shares = _core.left_share(points, 0.01)
    np.testing.assert_allclose(shares[:3], [0.5, 1, 0])
    assert shares[3] + shares[4] == pytest.approx(1) and shares[3] > 0.5
    with pytest.raises(InvalidInput, match="margin"):
        _core.left_share(points, 0)
