# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the values of a face act together: data/co_contraction.toml, learned on many heads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import SIDES, load_table
from mimetic.muscles.sides import mirrored_name

SIDES_TOGETHER = 0.8  # of both sides of what is in no table: lids


def correlation(names: Sequence[str], together: bool = True) -> NDArray[np.float64]:
    """M x M of the values about 0; names: of muscles and articulators, both sides of each.

    together: whether muscles that act together in most people do; else the two sides alone.
    """
    index = {name: at for at, name in enumerate(names)}
    matrix = np.eye(len(names))

    def put(first: str, second: str, value: float) -> None:
        if first != second and first in index and second in index:
            matrix[index[first], index[second]] = matrix[index[second], index[first]] = value

    for name in names:
        put(name, mirrored_name(name), SIDES_TOGETHER)
    if not together:
        return matrix
    left, right = SIDES
    for first, second, same, across in load_table("co_contraction.toml")["correlations"]:
        for side, other in ((left, right), (right, left)):
            put(f"{first}.{side}", f"{second}.{side}", same)
            put(f"{first}.{side}", f"{second}.{other}", across)
    return matrix
