# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.muscles import anatomy
from mimetic.template.face_template import load_template

from evaluation.anatomy import excursions
from evaluation.anatomy.expressiveness import (
    Columns,
    Gauge,
    composites,
    explained,
    face_weight,
    head_columns,
    likeness,
    skin_units,
)
from evaluation.anatomy.least_squares import bounded_fit


@pytest.fixture(scope="module")
def skin():
    template = load_template()
    return anatomy.attach_skin(template.vertices, template)


@pytest.fixture(scope="module")
def table(skin):
    return head_columns(skin, 10)


@pytest.fixture(scope="module")
def units(skin):
    return skin_units(skin.mesh.template)


def test_a_bounded_fit_meets_the_conditions_of_an_optimum():
    random = np.random.default_rng(0)
    system = random.normal(size=(60, 12)) @ random.normal(size=(12, 12))  # ill conditioned
    target = random.normal(size=(60, 5))
    lowest, highest = np.full(12, -0.02), np.full(12, 0.05)
    lowest[:2], highest[:2] = -np.inf, np.inf
    values = bounded_fit(system, target, lowest, highest)
    slope = system.T @ (system @ values - target)
    at_low = values <= lowest[:, None] + 1e-12
    at_high = values >= highest[:, None] - 1e-12
    assert at_low.any()
    assert at_high.any()
    assert (values >= lowest[:, None]).all()
    assert (values <= highest[:, None]).all()
    small = 1e-3 * np.abs(system.T @ target).max()
    assert np.abs(slope[~at_low & ~at_high]).max() < small
    assert slope[at_low].min() > -small
    assert slope[at_high].max() < small


def test_a_bounded_fit_refuses_bounds_that_cross():
    with pytest.raises(InvalidInput, match="lower bound"):
        bounded_fit(np.eye(2), np.ones((2, 1)), np.ones(2), np.zeros(2))
    with pytest.raises(InvalidInput, match="do not fit"):
        bounded_fit(np.eye(3), np.ones((2, 1)), np.zeros(3), np.ones(3))


def test_what_columns_hold_is_explained_and_what_bounds_forbid_is_not(skin, table):
    columns = table[0][1]
    gauge = Gauge(skin)
    cheek_raiser = columns.modes[columns.names.index("orbicularis_oculi_inferior.L")]
    inside, beyond = 0.7 * cheek_raiser, -cheek_raiser  # nothing lowers the cheek
    scores = explained(columns, gauge, [inside, beyond], 3)
    assert scores[0] > 0.9999
    assert scores[1] < 0.5


def test_every_row_explains_more_of_the_sculpted_units(skin, table, units):
    gauge = Gauge(skin)
    whole = composites(units)
    floors = ((0.50, 0.55), (0.66, 0.73), (0.74, 0.79), (0.77, 0.82))
    last = np.zeros(2)
    for (title, columns), floor in zip(table, floors, strict=True):
        scores = [explained(columns, gauge, list(t.values()), 3) for t in (units, whole)]
        means = np.array([score.mean() for score in scores])
        assert (means > floor).all(), (title, means)
        assert (means > last).all(), (title, means)
        last = means


def test_low_energy_modes_are_broad_and_independent(skin, table):
    gauge = Gauge(skin)
    gauge.weight = face_weight(gauge)
    gauge.kept = np.flatnonzero(gauge.weight)
    fields = np.stack([gauge.field(mode) for mode in table[-1][1].modes[-10:]])
    np.testing.assert_allclose(np.linalg.norm(fields, axis=1), 1e-3, rtol=1e-9)
    assert np.linalg.cond(fields) < 2
    stiffest = gauge.field(anatomy.modes_of(skin).muscle_modes[8])  # procerus: narrow
    share = np.linalg.lstsq(fields.T, stiffest, rcond=None)[0] @ fields
    assert np.linalg.norm(share) < 0.8 * np.linalg.norm(stiffest)


def test_fields_resemble_the_units_of_their_action_units(skin, table, units):
    columns = Columns(*(getattr(table[2][1], key) for key in ("names", "modes", "limits")))
    result = {
        unit: correlation for unit, _, correlation, _ in likeness(columns, Gauge(skin), units)
    }
    assert len(result) == 23
    assert result["jawOpen"] > 0.95
    assert result["mouthSmile"] > 0.85
    assert result["eyeBlink"] > 0.9
    assert min(result.values()) > 0.2


def test_excursions_lie_in_their_published_ranges(skin):
    rows = excursions.excursions(skin.mesh, anatomy.modes_of(skin))
    assert len(rows) == 18 + len(excursions.TOGETHER)
    assert [row.name for row in rows if not row.inside] == []
    assert max(row.difference for row in rows) < 1e-6
    for row, data in zip(rows, anatomy.muscle_table(), strict=False):
        assert row.length == pytest.approx(data["excursion_mm"], rel=1e-6)
    off = excursions.Excursion("x", np.array([0.0, 7.0, 0.0]), 0.0, 7.0, (8, 12), "")
    assert not off.inside
