# SPDX-License-Identifier: GPL-3.0-or-later
"""The seven muscle groups, and which face units they answer for (by their action units)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.performance.document import Performance
from mimetic.score import scores
from mimetic.score.truth import Truth

GROUP_NAMES = {
    1: "lip-corner pullers",
    2: "upper lip, nose",
    3: "lip depressors",
    4: "chin, orbicularis oris",
    5: "brow raisers",
    6: "brow lowerers",
    7: "eye sphincter",
}
UNIT_GROUPS = {
    "mouthSmile": 1,
    "mouthDimple": 1,
    "mouthStretch": 1,
    "noseSneer": 2,
    "mouthUpperUp": 2,
    "mouthFrown": 3,
    "mouthLowerDown": 3,
    "mouthPucker": 4,
    "mouthFunnel": 4,
    "mouthPress": 4,
    "mouthShrugLower": 4,
    "browInnerUp": 5,
    "browOuterUp": 5,
    "browDown": 6,
    "eyeSquint": 7,
    "cheekSquint": 7,
}
# Parts of the two sphincters that the model moves by articulators: pressed lips (action unit 24)
# and a tightened lower lid (7) are read as these.
GROUP_ARTICULATORS = {
    4: ("oris_close_upper", "oris_close_lower"),
    7: ("lid_lower.L", "lid_lower.R"),
}
UNIT_ARTICULATORS = {
    "jawOpen": ("jaw_open",),
    "eyeBlinkLeft": ("lid_upper.L",),
    "eyeBlinkRight": ("lid_upper.R",),
}


def by_group(values: NDArray, groups: NDArray) -> dict[int, NDArray[np.float64]]:
    """Summed values (N) of each group from values (N,M) and groups (M), 0 for none."""
    return {g: values[:, groups == g].sum(1) for g in GROUP_NAMES if (groups == g).any()}


def units_by_group(performance: Performance) -> dict[int, NDArray[np.float64]]:
    """What is read of each group's face units (N): its muscles, and articulators of their part."""
    sums = by_group(performance.activations, performance.groups)
    for group, names in GROUP_ARTICULATORS.items():
        columns = [i for i, name in enumerate(performance.articulators) if name in names]
        if group in sums:
            sums[group] = sums[group] + performance.articulator_values[:, columns].clip(0).sum(1)
    return sums


def group_curves(
    truth: Truth, performance: Performance
) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """True and estimated sums (N) over each muscle group that truth moves, by name.

    The estimate of face units counts the sphincters' articulators too (`GROUP_ARTICULATORS`).
    """
    true: dict[int, NDArray[np.float64]] = {}
    estimates = by_group(performance.activations, performance.groups)
    if truth.units is not None and truth.unit_values is not None:
        true = by_group(truth.unit_values, unit_groups(truth.units))
        estimates = units_by_group(performance)
    elif truth.activations is not None and truth.groups is not None:
        true = by_group(truth.activations, truth.groups)
    return {
        GROUP_NAMES[group]: (values, estimates[group])
        for group, values in true.items()
        if values.max() > scores.ACTIVE and group in estimates
    }


def unit_groups(units: list[str]) -> NDArray[np.int64]:
    """Muscle group of every face unit, 0 for those that no group answers for."""
    plain = (u.removesuffix("Left").removesuffix("Right") for u in units)
    return np.array([UNIT_GROUPS.get(name, 0) for name in plain])
