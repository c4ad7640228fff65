# SPDX-License-Identifier: GPL-3.0-or-later
"""What is learned of muscles that a picture hardly tells apart, on heads made up for it."""

import numpy as np
import pytest

from scripts.build.co_contraction.heads import Head
from scripts.build.co_contraction.learning import learned, rows

MUSCLES = ("corrugator_supercilii", "procerus", "mentalis")
NAMES = tuple(f"{muscle}.{side}" for muscle in MUSCLES for side in "LR")
UNITS = ("browDownLeft", "browDownRight", "noseSneerLeft", "noseSneerRight")


def head(seed: int) -> Head:
    """Corrugator and procerus move nearly the same; browDown is half of each on every head."""
    rng = np.random.default_rng(seed)
    moves = 1e-3 * rng.normal(size=(40, len(NAMES)))
    moves[:, 2:4] = moves[:, :2] + 2e-4 * rng.normal(size=(40, 2))
    units = np.zeros((40, len(UNITS)))
    units[:, :2] = 0.5 * (moves[:, :2] + moves[:, 2:4])
    units[:, 2:] = 0.5 * moves[:, 4:]
    return Head(
        NAMES,
        UNITS,
        len(NAMES),
        np.tile([0.0, 1.0], (len(NAMES), 1)),
        moves.T @ moves,
        moves.T @ units,
        moves.T @ moves,
    )


@pytest.fixture(scope="module")
def correlation():
    return learned([head(seed) for seed in range(3)], lambda line: None)


def test_muscles_that_explain_a_unit_on_every_head_go_together(correlation):
    assert correlation[0, 2] > 0.5
    np.testing.assert_allclose(np.diag(correlation), 1)
    assert np.linalg.eigvalsh(correlation)[0] > 0.01


def test_both_sides_are_alike(correlation):
    assert correlation[0, 2] == pytest.approx(correlation[1, 3])
    assert correlation[0, 3] == pytest.approx(correlation[1, 2])


def test_a_muscle_that_ends_elsewhere_goes_with_its_other_side_alone(correlation):
    assert np.abs(correlation[4:, :4]).max() == 0
    table = {row[:2]: row[2:] for row in rows(correlation, NAMES)}
    assert ("corrugator_supercilii", "mentalis") not in table
    assert table["mentalis", "mentalis"][0] == 1
    assert set(table) == {(a, a) for a in MUSCLES} | {("corrugator_supercilii", "procerus")}
