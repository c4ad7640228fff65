# SPDX-License-Identifier: GPL-3.0-or-later
"""The correlation of muscles that explains the face units of all heads best.

Each head's expressions are random mixtures of face units. Given a covariance of the values, every
expression's likeliest values and what they leave open are found; their mean second moment is the
next covariance (expectation maximisation). A group that explains a unit on every head is so
preferred to a member that explains it on one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from mimetic.muscles.anatomy import SIDES
from mimetic.muscles.co_contraction import SIDES_TOGETHER
from mimetic.muscles.sides import mirrored_name, mirrored_sign
from numpy.typing import NDArray

from evaluation.anatomy.least_squares import bounded_fit
from evaluation.anatomy.unit_muscles import UNIT_MUSCLES

from .heads import Head

EXPRESSIONS, MOST_UNITS = 150, 3  # of a head; units in one
SEED = 5
ROUNDS = 20
INFORMATION = 3e8  # metres^-2: 300 independent points, a millimetre each, mostly the modes' error
FIRST_STD = 0.3
NOT_EXPLAINED = ("cheekPuff",)  # air has no part in a capture
# Muscles of one function that end at one place: the only ones whose correlations are kept. Beyond
# them what goes together is what the drawn units pair; with those too more muscles at rest are read
# as active, and intervals hold less (docs/measured/consistency.md).
GROUPS = (
    ("frontalis_medial", "frontalis_middle", "frontalis_lateral"),
    ("corrugator_supercilii", "procerus", "depressor_supercilii"),
    (
        "zygomaticus_minor",
        "zygomaticus_major",
        "levator_anguli_oris",
        "risorius",
        "depressor_anguli_oris",
    ),
)
SIDE_NAMES = ("Left", "Right")
ALIKE = 0.1  # overlap of two motions, below which one does not stand for the other
LEAST_EIGENVALUE = 0.03
LEAST_SHOWN = 0.01


def learned(heads: Sequence[Head], report: Callable[[str], None]) -> NDArray[np.float64]:
    """Correlation of the muscles, both sides alike; heads: of the same names."""
    other = _other_side(heads[0])
    rng = np.random.default_rng(SEED)
    mixed = [head.by_unit @ _mixtures(head.units, rng) for head in heads]
    covariance = FIRST_STD**2 * (np.eye(len(other)) + SIDES_TOGETHER * np.eye(len(other))[other])
    np.fill_diagonal(covariance, FIRST_STD**2)
    for number in range(ROUNDS):
        moments = [_moment(*of_head, covariance) for of_head in zip(heads, mixed, strict=True)]
        moment = _mirrored(np.mean(moments, axis=0), heads[0], other)
        change = np.abs(moment - covariance).max()
        covariance = moment
        report(f"round {number + 1} of {ROUNDS}: the covariance changes by {change:.4f}")
    return _of_neighbours(covariance, heads, other)


def _mixtures(units: Sequence[str], rng: np.random.Generator) -> NDArray[np.float64]:
    """U x EXPRESSIONS weights; a unit's two sides are seldom far from alike."""
    whole = {
        name: [units.index(n) for n in (name, *(name + side for side in SIDE_NAMES)) if n in units]
        for name in UNIT_MUSCLES
        if name not in NOT_EXPLAINED
    }
    whole = {name: sides for name, sides in whole.items() if sides}
    most = min(MOST_UNITS, len(whole))
    weights = np.zeros((len(units), EXPRESSIONS))
    for column in weights.T:
        for name in rng.choice(list(whole), rng.integers(1, most + 1), replace=False):
            sides = whole[name]
            shares = np.ones(len(sides))
            least = 0.8 if rng.random() < 0.9 else 0.0
            shares[rng.integers(len(sides))] = rng.uniform(least, 1)
            column[sides] = rng.uniform(0.4, 1) * shares
    return weights


def _moment(head: Head, by_expression, covariance) -> NDArray[np.float64]:
    """Mean second moment of the values, what is left open included."""
    precision = INFORMATION * head.gram + np.linalg.inv(covariance)
    root = np.linalg.cholesky(precision)
    wanted = np.linalg.solve(root, INFORMATION * by_expression)
    values = bounded_fit(root.T, wanted, head.limits[:, 0], head.limits[:, 1])
    return values @ values.T / values.shape[1] + np.linalg.inv(precision)


def _other_side(head: Head) -> NDArray[np.int32]:
    """Index of each value's other side, its own in the middle."""
    return np.array([head.names.index(mirrored_name(name)) for name in head.names], dtype=np.int32)


def _mirrored(matrix, head: Head, other) -> NDArray[np.float64]:
    sign = np.array([mirrored_sign(name) for name in head.names])
    return (matrix + (sign[:, None] * matrix * sign)[np.ix_(other, other)]) / 2


def _of_neighbours(covariance, heads: Sequence[Head], other) -> NDArray[np.float64]:
    """Correlations of muscles of a group that move the skin alike, and of both sides of each.

    Of these the sparsest answer takes one, as chance has it. Those that move other skin go together
    in the units that were drawn, in others apart; and where one goes with what undoes it in part
    (the smile's muscle with the depressor of the mouth's corner), smiles are read as both.
    """
    count = heads[0].num_muscles
    other = other[:count]
    overlaps = np.mean([_correlation(head.overlaps) for head in heads], axis=0)[:count, :count]
    overlaps = (overlaps + overlaps[np.ix_(other, other)]) / 2
    is_kept = np.maximum(overlaps, overlaps[:, other]) >= ALIKE
    groups = np.array([_group_of(name.rpartition(".")[0]) for name in heads[0].names[:count]])
    is_kept &= (groups[:, None] == groups) & (groups >= 0)
    np.fill_diagonal(is_kept, True)
    is_kept[np.arange(count), other] = True
    kept = np.where(is_kept, _correlation(covariance)[:count, :count], 0)
    size, vectors = np.linalg.eigh(kept)
    return _correlation(vectors * np.maximum(size, LEAST_EIGENVALUE) @ vectors.T)


def _group_of(muscle: str) -> int:
    """Its index in `GROUPS`, -1 for none."""
    return next((at for at, members in enumerate(GROUPS) if muscle in members), -1)


def _correlation(covariance) -> NDArray[np.float64]:
    std = np.sqrt(np.diag(covariance))
    return covariance / std[:, None] / std


def rows(correlation, names: Sequence[str]) -> list[tuple[str, str, float, float]]:
    """Of every two muscles, without side: correlation on the same side and across, if any."""
    left, right = SIDES
    bare = list(dict.fromkeys(name.rpartition(".")[0] for name in names))
    table = []
    for i, a in enumerate(bare):
        for b in bare[i:]:
            same, across = (
                round(float(correlation[names.index(f"{a}.{left}"), names.index(f"{b}.{s}")]), 3)
                for s in (left, right)
            )
            if max(abs(same), abs(across)) >= LEAST_SHOWN:
                table.append((a, b, same, across))
    return table
