# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads too fine to be solved: the template's skin carries them, beside the same ones solved."""

import numpy as np
import pytest
from mimetic.character import foreign_head
from mimetic.character.foreign_head import attach_foreign

from evaluation.anatomy.foreign_agreement import compare


@pytest.fixture(scope="module")
def carried(template, head):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(foreign_head, "MOST_SOLVED", 1000)
        return attach_foreign(head.vertices, head.faces, head.landmarks, template)


def test_a_carried_skin_moves_as_a_solved_one(foreign, carried):
    for kind in ("anatomy.muscle", "anatomy.articulator", "extras."):
        part, prefix = kind.split(".")
        field, names = (f"{prefix}_modes", f"{prefix}_names") if prefix else ("modes", "names")
        one, other = getattr(foreign, part), getattr(carried, part)
        for name, own, mode in zip(
            getattr(one, names), getattr(one, field), getattr(other, field), strict=True
        ):
            lengths = np.linalg.norm(own), np.linalg.norm(mode)
            assert (own * mode).sum() / np.prod(lengths) > 0.97, name
            assert 0.9 < lengths[1] / lengths[0] < 1.1, name


def test_it_moves_as_the_persons_own_mesh(head, direct, carried):
    rows = compare(head, direct, carried)
    assert min(row.cosine for row in rows) > 0.85
    assert np.median([row.cosine for row in rows]) > 0.98


def test_loose_parts_go_with_the_jaw_or_stay(template, head, foreign, carried):
    loose = np.flatnonzero(head.skin_vertex < 0)
    still = np.isin(head.control_vertex[loose], template.part_vertices("teeth_upper"))
    assert not carried.anatomy.muscle_modes[:, loose[still]].any()
    teeth = loose[np.isin(head.control_vertex[loose], template.part_vertices("teeth_lower"))]
    jaw = carried.anatomy.articulator_names.index("jaw_open")
    np.testing.assert_allclose(
        carried.anatomy.articulator_modes[jaw, teeth],
        foreign.anatomy.articulator_modes[jaw, teeth],
        atol=1e-9,
    )


def test_lips_and_lids_of_a_carried_skin_rest_on_each_other(carried):
    modes = dict(zip(carried.extras.names, carried.extras.modes, strict=True))
    lids = carried.anatomy.articulator_modes[3:].sum(axis=0)
    contact = carried.make_contact()
    for pressed in (modes["oris_close_upper"] + modes["oris_close_lower"], lids):
        assert contact.depth(pressed) > 0.001
        relieved = contact.relieve(pressed)
        assert contact.depth(relieved) < 1e-4
        assert np.linalg.norm(relieved - pressed, axis=1).max() < 0.01
    apart = carried.anatomy.articulator_modes[0]
    np.testing.assert_array_equal(contact.relieve(apart), apart)
