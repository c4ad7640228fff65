# SPDX-License-Identifier: GPL-3.0-or-later
"""What controls play by their names alone.

A character may have controls that mean the same: a blink of both eyes beside one of each, ARKit's
52 beside its maker's own. On one mesh their motions add up, so that each face unit is played once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic.retarget.control_names import KnownName, unit_shares
from mimetic.retarget.unit_fit import unit_order
from mimetic.template.face_template import load_template

Floats = NDArray[np.float64]


def by_shares(units: Floats, shares: Floats) -> Floats:
    """T x K of controls whose names have shares (K x 52, as `unit_shares`) of the units (T x 52, in
    the order of `unit_order`)."""
    columns = [unit_order().index(name) for name in load_template().unit_names]
    return units[:, columns] @ shares.T


def shares_once(
    names: Sequence[str], known: Mapping[str, KnownName], is_shared: NDArray[np.bool_]
) -> Floats:
    """K x 52: as `unit_shares`, but that controls of one mesh do not play a unit twice.

    is_shared: K, which controls move that mesh; others play all that they mean. A unit is left to
    one convention: that of a control which is this unit and nothing else, ARKit's own spelling
    first, then the character's order. There several may be its parts, as quarters of the lips are;
    but one of several units leaves those that another is alone, and a second spelling all.
    """
    shares, own = unit_shares(names, known), load_template().unit_names
    is_broad = np.count_nonzero(shares, axis=1) > 1
    is_alone = ~is_broad & (shares.max(axis=1, initial=0) == 1.0)
    among = sorted(
        np.flatnonzero(is_shared & shares.any(axis=1)).tolist(),
        key=lambda k: (not is_alone[k], names[k] not in own),
    )
    has_own = shares[[k for k in among if is_alone[k]]].any(axis=0)
    owners: dict[int, str] = {}
    spelled = set()
    for k in among:
        meaning = known[names[k]]
        for unit in np.flatnonzero(shares[k]).tolist():
            is_others = owners.setdefault(unit, meaning.convention) != meaning.convention
            if is_others or meaning.place in spelled or (is_broad[k] and has_own[unit]):
                shares[k, unit] = 0.0
        spelled.add(meaning.place)
    return shares
