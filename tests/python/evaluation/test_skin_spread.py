# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic.skin.mesh import SkinMesh, find_place
from mimetic.template.face_template import load_template

from evaluation.anatomy import skin_spread

LENGTH = 12.5e-3


def test_single_pull_spreads_over_the_length_of_the_theory_all_over_the_face():
    for place, lengths in skin_spread.measure(LENGTH).items():
        assert lengths == pytest.approx((LENGTH, LENGTH), rel=0.05), place


def test_a_softer_attachment_is_measured_as_a_longer_spread():
    template = load_template()
    mesh = SkinMesh(template, np.ascontiguousarray(template.vertices))
    skin = skin_spread.EvenSkin(mesh, 1.2 * LENGTH)
    place = find_place(mesh, *skin_spread.PLACES["cheek"], 0, "L").vertex
    result = skin_spread.spread_length(skin, place, np.array([1.0, 0, 0]))
    assert result == pytest.approx(1.2 * LENGTH, rel=0.05)


def test_theory_holds_the_pull_in_balance_and_is_even_in_both_directions():
    grid = np.stack(np.meshgrid(*[np.linspace(-0.12, 0.12, 121)] * 2, indexing="ij"), -1)
    field = skin_spread.flat_theory(grid.reshape(-1, 2), LENGTH).reshape(121, 121)
    foundation = skin_spread.STRETCH / LENGTH**2
    assert foundation * field.sum() * 0.002**2 == pytest.approx(1, rel=0.01)
    assert field == pytest.approx(field[::-1], abs=1e-9)
    assert field == pytest.approx(field[:, ::-1], abs=1e-9)
    assert field[61 + 20, 60] > field[60, 61 + 20]  # farther ahead than aside
