# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles that a performance's pictures cannot tell apart, and the words for them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.document import Performance
from mimetic.performance.evidence import evidence_factors
from mimetic.performance.gaze import GAZE

SHOWN_PAIRS = 6  # those of the most frames; the rest is in the file


@dataclass(frozen=True)
class Confounded:
    """A muscle at work and what the pictures cannot tell it from."""

    muscle: str
    other: str  # a muscle, or an articulator
    frame: NDArray[np.int64]  # footage frames, ascending


def with_confounding(performance: Performance) -> Performance:
    """The performance with `confounded_with` by its evidence; as it is where it has none."""
    if performance.evidence is None:
        return performance
    extent = performance.muscle_extent
    scale = np.ones(len(performance.muscles)) if extent is None else extent
    num_others = sum(name not in GAZE for name in performance.articulators)
    # In units of the strength that is assumed: what counts as sure must not depend on how far this
    # person's muscle goes
    values = _core.confounded_values(
        performance.activations * scale,
        performance.activations_std * scale,
        performance.evidence * evidence_factors(np.append(1 / scale, np.ones(num_others))),
    )
    # Evidence is of muscles, then of articulators without gaze
    names = performance.muscles + performance.articulators
    measured = [names.index(name) for name in names if name not in GAZE]
    index = np.append(np.array(measured, dtype=np.int64), -1)
    return replace(performance, confounded_with=index[values])


def confounded_name(performance: Performance, i: int, muscle: str) -> str:
    """What a muscle cannot be told from at frame index `i`; "" for nothing."""
    if performance.confounded_with is None or muscle not in performance.muscles:
        return ""
    other = int(performance.confounded_with[i, performance.muscles.index(muscle)])
    return (performance.muscles + performance.articulators)[other] if other >= 0 else ""


def confounded_pairs(performance: Performance) -> list[Confounded]:
    """Each pair once, named by the one at work in more of the frames; most frames first."""
    if performance.confounded_with is None:
        return []
    names = performance.muscles + performance.articulators
    rows: dict[frozenset[int], set[int]] = {}
    for row, muscle in np.argwhere(performance.confounded_with >= 0).tolist():
        other = int(performance.confounded_with[row, muscle])
        rows.setdefault(frozenset((muscle, other)), set()).add(row)
    at_work = performance.activations.sum(axis=0)
    pairs = []
    for pair, indices in rows.items():
        muscles = [k for k in pair if k < len(performance.muscles)]
        muscle = max(muscles, key=lambda k: (at_work[k], -k))
        (other,) = pair - {muscle}
        frames = performance.frame[sorted(indices)]
        pairs.append(Confounded(names[muscle], names[other], frames))
    return sorted(pairs, key=lambda pair: (-len(pair.frame), pair.muscle))


def confounding_text(performance: Performance) -> str:
    """Which pairs cannot be told apart, in a line; "" where all can, or nothing is known."""
    pairs = confounded_pairs(performance)
    parts = [
        f"{pair.muscle} and {pair.other} ({len(pair.frame)} frames)" for pair in pairs[:SHOWN_PAIRS]
    ]
    more = f", {len(pairs) - SHOWN_PAIRS} more" if len(pairs) > SHOWN_PAIRS else ""
    return ", ".join(parts) + more
