# SPDX-License-Identifier: GPL-3.0-or-later
"""How well the templates of a taught set tell its looks apart, and what to teach next."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic.performance.gaze import value_units
from mimetic.puppet.parts import FACE, KINDS
from mimetic.puppet.templates import TaughtSet

SCORE_NOISE = 0.02  # least standard deviation of scores of one look: light, noise, the head
HARD = 2.0  # d' below which two looks are hard to tell apart: one frame in six is mistaken
NEAR = 0.5  # of the distance to the other look, within which an example shows a look


class Pair(NamedTuple):
    """Two looks of one part; d_prime: of the difference of their templates' scores."""

    part: str
    first: str
    second: str
    d_prime: float


def separability(taught: TaughtSet) -> list[Pair]:
    """All pairs of looks that have a template of the same part, the hardest first.

    d' = difference of means / root of the mean variance, of what the second template scores less
    than the first, in the examples near the first look and in those near the second. A look that
    has no template, in sets of earlier versions, is 0 apart from the look that does most alike.
    """
    pairs = _without_template(taught)
    for part in KINDS:
        templates = taught.of_part(part)
        channels = taught.channels_of(part)
        for k, i in enumerate(templates):
            for j in templates[k + 1 :]:
                first, second = (int(taught.template_looks[t]) for t in (i, j))
                difference = taught.example_scores[:, i] - taught.example_scores[:, j]
                near_first, near_second = _near(taught, channels, first, second)
                d_prime = _d_prime(difference[near_first], difference[near_second])
                pairs.append(Pair(part, taught.looks[first], taught.looks[second], d_prime))
    return sorted(pairs, key=lambda pair: pair.d_prime)


def advice(pairs: list[Pair]) -> list[str]:
    """One line for each pair that is hard to tell apart."""
    lines = []
    for pair in pairs:
        if pair.d_prime < HARD:
            lines.append(
                f"{pair.first} and {pair.second} are hard to tell apart by the {_words(pair.part)} "
                f"(d' {pair.d_prime:.1f}): teach one more look that differs more, or leave one out"
            )
    return lines


def _without_template(taught: TaughtSet) -> list[Pair]:
    """Each look without a template beside the look with the nearest values."""
    rows = taught.look_values / value_units(taught.channels)
    pairs = []
    for look in sorted(set(range(len(rows))) - set(taught.template_looks.tolist())):
        distance = np.abs(rows - rows[look]).sum(axis=1)
        distance[look] = np.inf
        nearest = int(distance.argmin())
        pairs.append(Pair(FACE, taught.looks[nearest], taught.looks[look], 0.0))
    return pairs


def _near(
    taught: TaughtSet, channels: list[int], first: int, second: int
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    units = value_units(taught.channels)[channels]
    examples = taught.example_values[:, channels] / units
    looks = taught.look_values[:, channels] / units
    apart = max(float(np.sqrt(((looks[first] - looks[second]) ** 2).sum())), 1e-6)
    near = [np.sqrt(((examples - looks[look]) ** 2).sum(axis=1)) for look in (first, second)]
    near_first = (near[0] < NEAR * apart) | (near[0] == near[0].min())
    near_second = (near[1] < NEAR * apart) | (near[1] == near[1].min())
    return near_first, near_second


def _d_prime(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    variance = 0.5 * (first.var() + second.var()) + SCORE_NOISE**2
    # Looks whose templates are alike come out a little under 0, which tells no less than 0
    return max(0.0, float((first.mean() - second.mean()) / np.sqrt(variance)))


def _words(part: str) -> str:
    stem, _, side = part.partition(".")
    return {"L": "left ", "R": "right ", "": ""}[side] + stem
