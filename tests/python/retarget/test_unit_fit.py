# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance in ARKit's units: what one part of the face does does not show in another's."""

from dataclasses import replace

import numpy as np
import pytest
from acting import make_acting
from mimetic import InvalidInput
from mimetic.retarget.unit_fit import UnitFit, unit_order, unit_shapes, unit_values
from mimetic.template.face_template import load_template

RISE = np.array([0.1, 0.25, 0.5, 0.75, 1.0])


def moved(values: dict[str, np.ndarray], least: float = 0.02) -> dict[str, np.ndarray]:
    units = unit_values(make_acting(values))
    return {
        name: column
        for name, column in zip(unit_order(), units.T, strict=True)
        if column.max() > least
    }


def test_a_jaw_that_opens_leaves_the_lips_units_alone():
    units = moved({"jaw_open": RISE})
    assert list(units) == ["jawOpen"]
    np.testing.assert_allclose(units["jawOpen"], np.minimum(1.06 * RISE, 1), atol=0.03)


def test_lips_that_move_over_an_open_jaw_show_as_over_a_shut_one():
    lips = {"mentalis.L": RISE, "mentalis.R": RISE}
    shut, opened = moved(lips), moved({**lips, "jaw_open": RISE})
    jaw = opened.pop("jawOpen")
    assert jaw[-1] == pytest.approx(1, abs=0.05)
    assert shut.keys() == opened.keys()
    for name, column in shut.items():
        np.testing.assert_allclose(opened[name], column, atol=1e-9)


def test_a_lid_that_shuts_is_a_blink_and_nothing_else():
    units = moved({"lid_upper.R": RISE})
    assert list(units) == ["eyeBlinkRight"]
    np.testing.assert_allclose(units["eyeBlinkRight"], RISE, atol=1e-9)


def test_a_lid_that_opens_wide_is_no_blink():
    units = moved({"lid_upper.L": -0.3 * RISE})
    assert list(units) == ["eyeWideLeft"]


def test_shapes_are_in_order_and_end_at_the_units():
    acting = make_acting({"jaw_open": RISE})
    shapes = unit_shapes(acting)
    assert tuple(shape.name for shape in shapes) == unit_order()
    template = load_template()
    modes = template.unit_modes[template.unit_names.index("jawOpen")]
    np.testing.assert_allclose(shapes[unit_order().index("jawOpen")].offsets, modes)
    assert all(shape.values.shape == RISE.shape for shape in shapes)


def test_another_mesh_is_refused():
    with pytest.raises(InvalidInput, match="not of the canonical head"):
        UnitFit(["a"], np.zeros((5, 3)), np.zeros((1, 5, 3)), np.array([[0.0, 1.0]]))


def test_muscles_alone_play_the_skins_units():
    acting = make_acting({"mentalis.L": RISE, "mentalis.R": RISE})
    units = unit_values(acting)
    alone = unit_values(replace(acting, articulator_modes=None))
    np.testing.assert_allclose(alone, units, atol=0.01)
