# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion that FACS lacks, of faces that muscles move: as true as a capture measures it.

What a capture adds to a face that moves by FACS alone (`timing_units`) must not be lowered by what
hides true motion; so the energy outside of a unit's region is measured beside its truth too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic import InvalidInput
from mimetic.analyse.comparison import compare
from mimetic.analyse.timing import Timing
from mimetic.muscles.action_units import action_unit, is_face
from mimetic.score.truth import Truth
from mimetic.template.face_template import FaceTemplate

UNITS = {"smile": "AU12", "brow raise": "AU2"}  # by expression


@dataclass(frozen=True)
class OutsideShare:
    """Shares of energy outside of a unit's region, over the truth's points in sight at the peak."""

    clip: str
    unit: str
    true: float
    measured: float


def outside_shares(
    name: str, timing: Timing, truth: Truth, template: FaceTemplate
) -> list[OutsideShare]:
    """Of each expression whose event was found."""
    shares = []
    for unit in UNITS.values():
        try:
            comparison = compare(timing, unit, template, only_certain=False)
        except InvalidInput:
            continue
        frames = timing.performance.frame[comparison.rows]
        first, peak = np.searchsorted(truth.frame, (frames[0], frames[comparison.peak]))
        nearest = _nearest(truth.neutral_points, truth.neutral_vertices)
        counted = truth.visible[peak] & np.array(is_face(template))[nearest]
        is_outside = action_unit(unit, truth.neutral_vertices, template).reach[nearest] <= 0
        motions = (truth.points[peak] - truth.points[first], comparison.seen[nearest])
        energies = [np.sum(motion**2, axis=1) * counted for motion in motions]
        true, measured = (float(e[is_outside].sum() / e.sum()) for e in energies)
        shares.append(OutsideShare(name, unit, true, measured))
    return shares


def outside_rows(shares: list[OutsideShare]) -> list[tuple[str, str]]:
    rows = []
    for expression, unit in UNITS.items():
        of_unit = [one for one in shares if one.unit == unit]
        if not of_unit:
            continue
        true = np.array([one.true for one in of_unit])
        measured = np.array([one.measured for one in of_unit])
        text = f"true {_range(true)}, measured {_range(measured)}"
        text += f"; measured of true {_range(measured / true)}"
        rows.append((f"{expression} by muscles, energy outside {unit}", text))
    return rows


def _range(shares: np.ndarray) -> str:
    low, middle, high = (100 * np.percentile(shares, q) for q in (0, 50, 100))
    return f"{middle:.0f} % ({low:.0f} to {high:.0f})"


def _nearest(points: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """K indices into the vertices (V x 3), of each of K points."""
    return np.array([((vertices - point) ** 2).sum(axis=1).argmin() for point in points])
