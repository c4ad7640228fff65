# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate consistency`: whether people's expressions are read as the same muscles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.runs.expressions import takes
from evaluation.runs.kept_captures import KeptCaptures

# Those of people who are moved by face units
SETS = {"held-out": "full", "tuning": "consistency-tuning"}
NEAR_PEAK = 0.9  # of an expression's largest movement: frames that count as its height
LEAST_SPREAD = 0.1  # of the features' root mean square
RIDGES = (0.03, 0.3, 3.0, 30.0, 300.0)  # chosen by leaving out a fifth of those learned from
FOLDS = 5
MUSCLES, LANDMARKS = "muscles", "landmarks"
PATTERN_COLUMNS = {
    "people": ("people", "d"),
    "median": ("median", ".2f"),
    "worst": ("worst pair", ".2f"),
}
UNIT_COLUMNS = {MUSCLES: ("muscles", ".2f"), LANDMARKS: ("landmarks", ".2f")}
Report = Callable[[str], None]


@dataclass(frozen=True)
class Person:
    """What one person shows in N frames, and what was read of it."""

    name: str
    patterns: dict[str, NDArray[np.float64]]  # by expression, P: mean activations at its height
    readings: dict[str, NDArray[np.float64]]  # by MUSCLES and LANDMARKS, N x features
    units: list[str]
    unit_values: NDArray[np.float64]  # N x U


@dataclass(frozen=True)
class Consistency:
    people: list[Person]

    def cosines(self, expression: str) -> dict[tuple[str, str], float]:
        """Between the patterns of every two people who show it."""
        shown = [one for one in self.people if expression in one.patterns]
        return {
            (a.name, b.name): _cosine(a.patterns[expression], b.patterns[expression])
            for a, b in combinations(shown, 2)
        }

    def expressions(self) -> list[str]:
        return list(dict.fromkeys(name for one in self.people for name in one.patterns))

    def decoded(self, reading: str) -> dict[str, float]:
        """By face unit: correlation of its true weights with those decoded, on people whom the
        linear map was not learned on, either half of them in turn.
        """
        halves = self.people[::2], self.people[1::2]
        found, true = [], []
        for learned, tested in (halves, halves[::-1]):
            decode = _decoder([(one.readings[reading], one.unit_values) for one in learned])
            found += [decode(one.readings[reading]) for one in tested]
            true += [one.unit_values for one in tested]
        units = self.people[0].units
        pairs = zip(units, np.concatenate(found).T, np.concatenate(true).T, strict=True)
        in_both = [
            all(any(one.unit_values[:, i].any() for one in half) for half in halves)
            for i in range(len(units))
        ]
        return {
            unit: float(np.corrcoef(a, b)[0, 1])
            for (unit, a, b), is_shown in zip(pairs, in_both, strict=True)
            if is_shown
        }


def score_consistency(
    which: str, people: int | None, out: Path | None, folder: Path | None, report: Report
) -> Consistency:
    """The people of a set, or some of them; captures are kept in `out`, or come from `folder`."""
    kept = KeptCaptures(out, folder, report)
    return Consistency(list(_people(SETS[which], people, kept, report)))


def _people(which: str, people: int | None, kept: KeptCaptures, report: Report) -> Iterator[Person]:
    marks = load_template().landmark_vertices
    for take in takes(which, people, report)[0]:
        if take.kind == "units":
            performance = kept.of(take.clip.name, lambda take=take: take.clip)
            yield person_of(take.clip.name, Truth.load(take.clip.truth), performance, marks)


def person_of(
    name: str, truth: Truth, performance: Performance, marks: NDArray[np.int32]
) -> Person:
    """marks: the vertices of the canonical head's landmarks."""
    rest = performance.neutral_vertices[marks]
    moved = [(performance.surface(i)[marks] - rest).ravel() for i in range(performance.num_frames)]
    values = np.hstack([performance.activations, performance.articulator_values])
    units = truth.unit_values[np.searchsorted(truth.frame, performance.frame)]
    movement = units.sum(axis=1)
    patterns = {}
    for expression, (first, last) in zip(truth.expressions, truth.expression_frames, strict=True):
        rows = np.flatnonzero((performance.frame >= first) & (performance.frame <= last))
        high = rows[movement[rows] >= NEAR_PEAK * movement[rows].max()]
        patterns[expression] = performance.activations[high].mean(axis=0)
    readings = {MUSCLES: values, LANDMARKS: np.array(moved)}
    return Person(name, patterns, readings, truth.units, units)


def _cosine(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    length = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / length if length > 0 else 0.0


def _decoder(
    people: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """A ridge regression from readings to face units, features scaled by their spread.

    What hardly moved in these people (a muscle that none of them used) counts little: scaled by its
    own spread it would be all that is decoded in somebody in whom it does move.
    """
    spread = np.concatenate([x for x, _ in people]).std(axis=0)
    scale = np.maximum(spread, LEAST_SPREAD * np.sqrt(np.mean(spread**2)))

    def solved(chosen: list[int], ridge: float) -> NDArray[np.float64]:
        x = np.concatenate([_with_one(people[i][0] / scale) for i in chosen])
        y = np.concatenate([people[i][1] for i in chosen])
        penalty = np.full(x.shape[1], ridge * len(chosen))
        penalty[-1] = 0
        return np.linalg.solve(x.T @ x + np.diag(penalty), x.T @ y)

    def left_out_error(ridge: float) -> float:
        error = 0.0
        for fold in range(min(FOLDS, len(people))):
            others = [i for i in range(len(people)) if i % FOLDS != fold]
            weights = solved(others, ridge)
            for i in range(fold, len(people), FOLDS):
                x, y = people[i]
                error += float(((_with_one(x / scale) @ weights - y) ** 2).sum())
        return error

    weights = solved(list(range(len(people))), min(RIDGES, key=left_out_error))
    return lambda readings: _with_one(readings / scale) @ weights


def _with_one(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hstack([x, np.ones((len(x), 1))])


def figures(scores: Consistency) -> dict[str, dict[str, dict]]:
    """Cosines by expression, correlations by face unit; the rows "all" hold medians."""
    patterns: dict[str, dict] = {}
    everything: dict[tuple[str, str], float] = {}
    for name in scores.expressions():
        cosines = scores.cosines(name)
        if cosines:
            patterns[name] = _row(len({p for pair in cosines for p in pair}), cosines)
            everything |= {(f"{name}: {a}", b): value for (a, b), value in cosines.items()}
    patterns["all"] = _row(len(scores.people), everything)
    decoded = {reading: scores.decoded(reading) for reading in UNIT_COLUMNS}
    units = {
        unit: {reading: decoded[reading][unit] for reading in UNIT_COLUMNS}
        for unit in decoded[MUSCLES]
    }
    units["all"] = {
        reading: float(np.median(list(decoded[reading].values()))) for reading in UNIT_COLUMNS
    }
    return {"patterns": patterns, "units": units}


def _row(people: int, cosines: dict[tuple[str, str], float]) -> dict:
    worst = min(cosines, key=cosines.get)
    return {
        "people": people,
        "median": float(np.median(list(cosines.values()))),
        "worst": cosines[worst],
        "pair": " and ".join(worst),
    }


def as_text(scores: Consistency) -> str:
    found = figures(scores)
    worst = "\n".join(
        f"  {name}: {row['pair']}" for name, row in found["patterns"].items() if name != "all"
    )
    return "\n\n".join(
        [
            text_table("cosine of two people's activations", PATTERN_COLUMNS, found["patterns"]),
            f"worst pairs\n{worst}",
            text_table(
                "face units decoded on people not learned on, correlation",
                UNIT_COLUMNS,
                found["units"],
            ),
        ]
    )


def as_json(scores: Consistency) -> str:
    return json_text(figures(scores))
