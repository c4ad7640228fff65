# SPDX-License-Identifier: GPL-3.0-or-later
import math

import numpy as np

from evaluation.runs.bootstrap import r2_interval
from evaluation.runs.deviation import Explained
from evaluation.runs.expression_tables import as_json, as_text
from evaluation.runs.expressions import ShownExpression
from evaluation.runs.methods import CHAINED, DIRECT, LOOP, MESH, MUSCLES, OURS, VERTICES

METHODS = (OURS, MUSCLES, LOOP, f"{LOOP}, muscles", CHAINED, DIRECT, MESH, VERTICES)


def people(errors) -> dict[str, list[Explained]]:
    """Each in two expressions."""
    return {
        f"person {k}": [Explained(0.5 * error, 0.5, 10, [np.ones(3)])] * 2
        for k, error in enumerate(errors)
    }


def test_people_who_are_alike_leave_no_doubt():
    low, high = r2_interval(people([0.2] * 6))
    assert math.isclose(low, 0.8) and math.isclose(high, 0.8)


def test_one_bad_person_widens_it_downwards():
    low, high = r2_interval(people([0.1] * 9 + [2.0]))
    middle = 1 - (0.9 + 2.0) / 10
    assert low < middle - 0.2 and middle < high <= 0.9


def test_of_one_person_nothing_is_known():
    assert all(map(math.isnan, r2_interval(people([0.1]))))
    still = {name: [Explained()] for name in "ab"}
    assert all(map(math.isnan, r2_interval(still)))


def test_it_holds_what_all_people_have_in_nine_of_ten_studies():
    random = np.random.default_rng(1)
    truth = 1 - 0.2
    held = [
        low <= truth <= high
        for low, high in (
            r2_interval(people(0.2 * random.gamma(4, 1 / 4, size=30))) for _ in range(300)
        )
    ]
    assert 0.83 < np.mean(held) < 0.95


def shown(take: str, expression: str, error: float) -> ShownExpression:
    parts = {method: Explained(error, 1.0, 10, [np.ones(3)]) for method in METHODS}
    return ShownExpression(expression, take, "units", "frontal", parts, parts)


def test_tables_say_between_which_values_it_lies():
    ones = [
        shown(f"full-{k:02d}", name, 0.1 * (k + 1)) for k in range(4) for name in ("smile", "frown")
    ]
    text = as_text(ones)
    table = text[text.index("R2 for nine in ten samples") :].split("\n\n")[0]
    all_row = table.splitlines()[-1].split()
    low, high = map(float, all_row[1:3])
    assert all_row[0] == "all" and low < 0.75 < high
    assert '"image_r2_interval"' in as_json(ones, {})
